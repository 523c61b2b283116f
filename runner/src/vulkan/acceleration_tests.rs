use super::super::testing::with_device;
use super::*;

/// Two triangles in one vertex and index buffer, with the second at an offset.
struct Triangles {
    vertices: Buffer,
    indices: Buffer,
}

fn triangles(device: &Device) -> Triangles {
    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let moved = corners.map(|[x, y, z]| [x, y, z + 1.0]);
    Triangles {
        vertices: Buffer::from_slice(device, "vertices", &[corners, moved].concat(), BUILD_INPUT).unwrap(),
        indices: Buffer::from_slice(device, "indices", &[0u32, 1, 2, 0, 2, 1], BUILD_INPUT).unwrap(),
    }
}

impl Triangles {
    fn geometry(&self, index: u64, opaque: bool) -> BlasGeometry {
        BlasGeometry {
            vertices: self.vertices.address() + 36 * index,
            vertex_count: 3,
            indices: self.indices.address() + 12 * index,
            triangle_count: 1,
            opaque,
        }
    }
}

fn instance(custom_index: u32, blas: usize) -> TlasInstance {
    let transform = [1.0, 0.0, 0.0, custom_index as f32, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    TlasInstance { transform, custom_index, mask: 0xff, blas, flags: Default::default() }
}

#[test]
fn records_are_vulkans() {
    assert_eq!(size_of::<InstanceRecord>(), size_of::<vk::AccelerationStructureInstanceKHR>());
    assert_eq!(align_of::<InstanceRecord>(), align_of::<vk::AccelerationStructureInstanceKHR>());
    let flags = vk::GeometryInstanceFlagsKHR::TRIANGLE_FACING_CULL_DISABLE;
    let set = BlasSet { structures: vec![], addresses: vec![0x1234_5678_9abc], storage: vec![] };
    let ours = TlasInstance { mask: 0x5a, flags, ..instance(0xabcdef, 0) }.record(&set).unwrap();
    let theirs = vk::AccelerationStructureInstanceKHR {
        transform: vk::TransformMatrixKHR { matrix: ours.transform },
        instance_custom_index_and_mask: vk::Packed24_8::new(0xabcdef, 0x5a),
        instance_shader_binding_table_record_offset_and_flags: vk::Packed24_8::new(0, flags.as_raw() as u8),
        acceleration_structure_reference: vk::AccelerationStructureReferenceKHR {
            device_handle: 0x1234_5678_9abc,
        },
    };
    // SAFETY: 64 bytes of integers and floats without padding (checked above), read as bytes.
    let theirs: [u8; 64] = unsafe { std::mem::transmute(theirs) };
    assert_eq!(bytemuck::bytes_of(&ours), theirs);
}

#[test]
fn two_instances_of_a_triangle() {
    with_device(|device| {
        let data = triangles(device);
        let set = BlasSet::build(device, &[[data.geometry(0, true)]]).unwrap();
        let tlas = Tlas::build(device, &set, &[instance(0, 0), instance(1, 0)]).unwrap();
        assert!(set.len() == 1 && set.bytes() > 0 && tlas.bytes() > 0);
    });
}

#[test]
fn meshes_of_several_geometries_and_of_none() {
    with_device(|device| {
        let data = triangles(device);
        let two = [data.geometry(0, true), data.geometry(1, false)];
        let meshes: Vec<Vec<BlasGeometry>> = (0..100).map(|i| two[..1 + i % 2].to_vec()).collect();
        let set = BlasSet::build(device, &meshes).unwrap();
        assert_eq!(set.len(), 100);
        Tlas::build(device, &set, &[]).unwrap();
        let instances: Vec<_> = (0..100).map(|i| instance(i, i as usize)).collect();
        Tlas::build(device, &set, &instances).unwrap();
        assert!(BlasSet::build::<Vec<BlasGeometry>>(device, &[]).unwrap().is_empty());
    });
}

#[test]
fn indices_out_of_range_are_refused() {
    with_device(|device| {
        let data = triangles(device);
        let set = BlasSet::build(device, &[[data.geometry(0, true)]]).unwrap();
        for (bad, word) in [(instance(1 << 24, 0), "16777216"), (instance(0, 1), "mesh 1 of 1")] {
            let Err(error) = Tlas::build(device, &set, &[bad]) else { panic!("{word} was accepted") };
            assert!(error.to_string().contains(word), "{error}");
        }
    });
}
