//! What a SPIR-V module declares: entry points, bindings, memory layouts.

use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{Decoration, ExecutionModel, Op, StorageClass};
use std::collections::BTreeMap;

/// A parsed module.
pub struct Spirv(Module);

/// Memory layout of a buffer's element or a payload: the kind of each 4-byte scalar (`f`, `u`) at its offset.
#[derive(Debug, PartialEq, Eq)]
pub struct Layout {
    /// Kinds in the order of their offsets.
    pub scalars: String,
    /// Offsets are 0, 4, 8, ... without a gap.
    pub dense: bool,
    /// Array stride of a buffer's element, in bytes.
    pub stride: Option<u32>,
}

impl Spirv {
    pub fn parse(code: &[u8]) -> Self {
        Spirv(rspirv::dr::load_bytes(code).expect("valid SPIR-V"))
    }

    /// (stage, name) of each entry point.
    pub fn entry_points(&self) -> Vec<(ExecutionModel, String)> {
        let entry = |i: &Instruction| match (&i.operands[0], &i.operands[2]) {
            (Operand::ExecutionModel(model), Operand::LiteralString(name)) => (*model, name.clone()),
            other => panic!("odd entry point {other:?}"),
        };
        self.0.entry_points.iter().map(entry).collect()
    }

    /// Workgroup size of a compute shader.
    pub fn workgroup(&self) -> Option<[u32; 3]> {
        let mode = self.0.execution_modes.iter().find(|i| i.operands.len() == 5)?;
        let size: Vec<u32> = mode.operands[2..].iter().map(literal).collect();
        size.try_into().ok()
    }

    /// (set, binding) -> layout of what is bound there; none for images and acceleration structures.
    pub fn bindings(&self) -> BTreeMap<(u32, u32), Option<Layout>> {
        let place = |v: &Instruction| {
            Some((self.decoration(v, Decoration::DescriptorSet)?, self.decoration(v, Decoration::Binding)?))
        };
        let pointee = |v: &Instruction| self.pointee(v.result_type.expect("typed variable"));
        self.variables().filter_map(|v| Some((place(v)?, self.buffer_layout(pointee(v))))).collect()
    }

    /// Layouts of the variables in `class` (payloads, push constants).
    pub fn layouts_of(&self, class: StorageClass) -> Vec<Layout> {
        let in_class = |v: &&Instruction| v.operands[0] == Operand::StorageClass(class);
        let layout =
            |v: &Instruction| self.layout(self.pointee(v.result_type.expect("typed variable")), None);
        self.variables().filter(in_class).map(layout).collect()
    }

    fn variables(&self) -> impl Iterator<Item = &Instruction> {
        self.0.types_global_values.iter().filter(|i| i.class.opcode == Op::Variable)
    }

    fn decoration(&self, of: &Instruction, decoration: Decoration) -> Option<u32> {
        let id = Operand::IdRef(of.result_id?);
        let found = self.0.annotations.iter().find(|i| {
            i.class.opcode == Op::Decorate
                && i.operands[0] == id
                && i.operands[1] == Operand::Decoration(decoration)
        })?;
        found.operands.get(2).map(literal)
    }

    fn type_of(&self, id: u32) -> &Instruction {
        self.0.types_global_values.iter().find(|i| i.result_id == Some(id)).expect("type is declared")
    }

    fn pointee(&self, pointer: u32) -> &Instruction {
        self.type_of(id(&self.type_of(pointer).operands[1]))
    }

    /// The element of a storage buffer (a struct around a runtime array), or a uniform block.
    fn buffer_layout(&self, block: &Instruction) -> Option<Layout> {
        if block.class.opcode != Op::TypeStruct {
            return None;
        }
        let member = self.type_of(id(&block.operands[0]));
        if member.class.opcode == Op::TypeRuntimeArray {
            let stride = self.decoration(member, Decoration::ArrayStride);
            return Some(self.layout(self.type_of(id(&member.operands[0])), stride));
        }
        Some(self.layout(block, None))
    }

    fn layout(&self, ty: &Instruction, stride: Option<u32>) -> Layout {
        let mut scalars = Vec::new();
        self.flatten(ty, 0, &mut scalars);
        scalars.sort();
        let dense = scalars.iter().enumerate().all(|(i, &(offset, _))| offset == 4 * i as u32);
        Layout { scalars: scalars.iter().map(|&(_, kind)| kind).collect(), dense, stride }
    }

    fn flatten(&self, ty: &Instruction, offset: u32, out: &mut Vec<(u32, char)>) {
        match ty.class.opcode {
            Op::TypeFloat => out.push((offset, 'f')),
            Op::TypeInt => out.push((offset, 'u')),
            Op::TypeVector => {
                let component = self.type_of(id(&ty.operands[0]));
                (0..literal(&ty.operands[1])).for_each(|i| self.flatten(component, offset + 4 * i, out));
            }
            Op::TypeArray => {
                let stride = self.decoration(ty, Decoration::ArrayStride).unwrap_or(4);
                let length = literal(&self.type_of(id(&ty.operands[1])).operands[0]);
                let element = self.type_of(id(&ty.operands[0]));
                (0..length).for_each(|i| self.flatten(element, offset + stride * i, out));
            }
            Op::TypeStruct => {
                // Without offsets (payloads) the members follow one another.
                let mut next = offset;
                for (i, member) in ty.operands.iter().enumerate() {
                    let at = self.member_offset(ty, i as u32).map_or(next, |o| offset + o);
                    self.flatten(self.type_of(id(member)), at, out);
                    next = out.iter().map(|&(o, _)| o + 4).max().unwrap_or(at);
                }
            }
            other => panic!("no layout for {other:?}"),
        }
    }

    fn member_offset(&self, ty: &Instruction, member: u32) -> Option<u32> {
        let wanted = [
            Operand::IdRef(ty.result_id?),
            Operand::LiteralBit32(member),
            Operand::Decoration(Decoration::Offset),
        ];
        let found = self
            .0
            .annotations
            .iter()
            .find(|i| i.class.opcode == Op::MemberDecorate && i.operands[..3] == wanted)?;
        found.operands.get(3).map(literal)
    }
}

fn id(operand: &Operand) -> u32 {
    match operand {
        Operand::IdRef(id) => *id,
        other => panic!("expected an id, found {other:?}"),
    }
}

fn literal(operand: &Operand) -> u32 {
    match operand {
        Operand::LiteralBit32(n) => *n,
        other => panic!("expected a number, found {other:?}"),
    }
}
