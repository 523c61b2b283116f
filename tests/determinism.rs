//! The same pixel of the same frame with the same seed is the same picture: in one process, in two, and at two resolutions.

use candela::frame::schedule::{Conditions, Rotation, Work, schedule};
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::{Settings, mode};
use std::process::Command;
use tests::gpu::{device, renderer, restir};
use tests::scenes::{camera, many_lights, occluded};

const SIZE: UVec2 = UVec2::new(64, 48);
/// Set in the second process.
const CHILD: &str = "CANDELA_DETERMINISM_CHILD";
const MARK: &str = "picture hash ";

fn settings() -> Settings {
    Settings { reservoirs: 2, spatial_iterations: 2, cells: 1, mode: mode::UNBIASED, ..Settings::default() }
}

/// None on a machine that may be without a device.
fn picture(seed: u32) -> Option<Vec<Vec3>> {
    let device = device()?;
    let mut renderer = renderer(&device, &occluded(many_lights()), SIZE, 2);
    Some(restir(&mut renderer, camera(SIZE), settings(), 3, seed))
}

fn bits(image: &[Vec3]) -> Vec<u32> {
    image.iter().flat_map(|c| c.to_array().map(f32::to_bits)).collect()
}

/// FNV-1a, 64 bits.
fn hash(image: &[Vec3]) -> u64 {
    let bytes = bits(image).into_iter().flat_map(u32::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn a_seed_gives_the_same_bits() {
    let (Some(first), Some(again), Some(other)) = (picture(7), picture(7), picture(8)) else { return };
    assert!(bits(&first) == bits(&again), "the same seed gave two pictures");
    assert!(bits(&first) != bits(&other), "another seed gave the same picture");
    assert!(first.iter().all(|c| c.is_finite()));
}

/// This test runs itself in a second process, which prints the hash of its picture.
#[test]
fn two_processes_give_the_same_bits() {
    let Some(image) = picture(7) else { return };
    if std::env::var(CHILD).is_ok() {
        println!("\n{MARK}{:016x}", hash(&image));
        return;
    }
    let program = std::env::current_exe().expect("this program");
    let output = Command::new(program)
        .args(["--exact", "two_processes_give_the_same_bits", "--nocapture"])
        .env(CHILD, "1")
        .output()
        .expect("the second process runs");
    let printed = String::from_utf8_lossy(&output.stdout);
    let theirs = printed.lines().find_map(|line| line.strip_prefix(MARK));
    assert_eq!(
        theirs,
        Some(format!("{:016x}", hash(&image)).as_str()),
        "the second process printed:\n{printed}"
    );
    let other = picture(8).map(|image| hash(&image));
    assert_ne!(other, Some(hash(&image)), "another seed gave the same hash");
}

/// Where nothing moves, temporal reuse has a pass without rays. It comes to the same bits as the pass that may trace some.
#[test]
fn known_visibility_changes_no_bit() {
    let Some(device) = device() else { return };
    for visibility_reuse in [0, 1] {
        let settings = Settings { visibility_reuse, ..settings() };
        let picture = |seeks: bool, seed: u32| {
            let mut renderer = renderer(&device, &occluded(many_lights()), SIZE, 2);
            renderer.ignore_motion(seeks);
            bits(&restir(&mut renderer, camera(SIZE), settings, 4, seed))
        };
        assert!(picture(false, 7) == picture(true, 7), "rays said something else than what was known");
        assert!(picture(false, 7) != picture(true, 8), "another seed gave the same picture");
    }
    let still = Conditions { still: true, ..Default::default() };
    let stems = |conditions| {
        let (steps, _) = schedule(&Work::Restir(settings()), conditions, Rotation::default());
        steps.iter().map(|step| step.pass.stem()).collect::<Vec<_>>()
    };
    assert!(stems(still).contains(&"temporal"));
    assert!(stems(Conditions::default()).contains(&"temporal_traced"));
}

/// The upper left quarter of a picture and a picture of that quarter alone draw the same numbers: pixel, frame and seed are all that
/// they depend on. Without reuse between pixels that is the same light in each, up to the few pixels where the rounding of another
/// camera tips the scales.
#[test]
fn resolutions_share_their_numbers() {
    let Some(device) = device() else { return };
    let scene = occluded(many_lights());
    let whole = camera(SIZE);
    let forward = whole.forward - 0.5 * whole.right + 0.5 * whole.up;
    let quarter = Camera { right: 0.5 * whole.right, up: 0.5 * whole.up, forward, ..whole };
    let alone = Settings { temporal: 0, spatial: 0, ..Settings::default() };
    let mut large = renderer(&device, &scene, SIZE, 1);
    let mut small = renderer(&device, &scene, SIZE / 2, 1);
    let expected = restir(&mut large, whole, alone, 1, 7);
    let differing = |small: &[Vec3]| {
        let pixels = (0..SIZE.element_product() / 4).map(|i| (i % (SIZE.x / 2), i / (SIZE.x / 2)));
        let same = |((x, y), b): ((u32, u32), &Vec3)| {
            let a = expected[(y * SIZE.x + x) as usize];
            (a - *b).abs().max_element() <= 1e-3 * a.max_element().max(b.max_element())
        };
        pixels.zip(small).filter(|&pair| !same(pair)).count()
    };
    let (same, other) = (
        differing(&restir(&mut small, quarter, alone, 1, 7)),
        differing(&restir(&mut small, quarter, alone, 1, 8)),
    );
    println!("{same} pixels differ with the same seed, {other} with another");
    assert!(same * 100 <= (SIZE.element_product() / 4) as usize, "{same} pixels differ");
    assert!(other * 4 > (SIZE.element_product() / 4) as usize, "another seed changes {other} pixels only");
}
