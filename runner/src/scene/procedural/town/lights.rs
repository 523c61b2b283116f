//! How many lights of each kind the town has, and the things that carry them.
//!
//! Of N lights, up to as many as there are of each: 35 % street lamps, 0.5 % floodlights, 3 % lamps of moving cars, 8 % signs and
//! posters, 40 % lit windows and shops. The square's own lights come first, the room's too; fairy lights are the rest.

use super::facade::Pane;
use super::garlands::{self, Garland};
use super::glow::{self, Glows};
use super::green::{self, Tree};
use super::houses::{self, House};
use super::lamps::{self, Kind, Lamp};
use super::lots::{self, Lot};
use super::materials::{Finish, Part};
use super::plan::{KERB, Plan};
use super::towers::{self, Site, Tower};
use super::{cars, room, signs, square, traffic};
use crate::scene::animation::Thing;
use crate::scene::emission::{Emission, Emitters};
use crate::scene::procedural::kit::Kit;
use crate::scene::procedural::shapes::cuboid;
use crate::scene::{Instance, PlacedLight, PointLight, SceneDescription, SpotLight};
use glam::{Affine3A, Mat3, Quat, Vec3};

/// Floodlights: cd, half-angles.
const FLOOD: f32 = 2e5;
const FLOODED: [f32; 2] = [0.2, 0.55];

/// What stands in the town.
pub struct Town {
    pub plan: Plan,
    pub designs: Vec<House>,
    pub lots: Vec<Lot>,
    pub towers: Vec<Tower>,
    pub sites: Vec<Site>,
    pub trees: Vec<Tree>,
    pub lamps: Vec<Lamp>,
    hall: Vec<Pane>,
}

impl Town {
    /// What there is at any number of lights, without ground and greenery.
    pub fn build(kit: &mut Kit, plan: Plan) -> Self {
        let designs = houses::designs();
        let mut lots = lots::lots(&plan, &designs);
        lots.sort_by(|a, b| a.distance().total_cmp(&b.distance()));
        let towers = towers::designs();
        let mut sites = towers::sites(&plan);
        sites.sort_by(|a, b| a.rect.center().length().total_cmp(&b.rect.center().length()));
        let mut trees = green::trees(&plan);
        trees.extend(square::trees());
        let lamps = lamps::lamps(&plan);
        let meshes: Vec<usize> = (designs.iter().enumerate())
            .map(|(i, house)| kit.mesh(&format!("house-{i}"), house.part.clone()))
            .collect();
        for lot in &lots {
            kit.place(meshes[lot.design], lot.transform);
        }
        let meshes: Vec<usize> = (towers.iter().enumerate())
            .map(|(i, tower)| kit.mesh(&format!("tower-{i}"), tower.part.clone()))
            .collect();
        for site in &sites {
            kit.place(meshes[site.design], site.transform);
        }
        if let Some(place) = room::transform(&plan) {
            let mesh = kit.mesh("room-house", room::house());
            kit.place(mesh, place);
        }
        let hall = square::add(kit);
        let parked =
            cars::COLORS.map(|color| kit.mesh(&format!("parked-{color:?}"), cars::mesh(color, false)));
        for (color, place) in cars::parked(&plan) {
            kit.place(parked[color], place);
        }
        Town { plan, designs, lots, towers, sites, trees, lamps, hall }
    }
}

/// Adds `count` lights and what carries them.
pub fn add(kit: &mut Kit, town: &mut Town, count: usize) {
    let share = |of: f64| (of * count as f64) as usize;
    moving_cars(kit, town, share(0.03) / 4);
    let mut emissive = Emissive { left: count - kit.scene.lights.len() };
    if emissive.fits(share(0.2), &square::dials()) {
        kit.single("dials", square::dials());
    }
    neon(kit, town, share(0.04), &mut emissive);
    posters(kit, town, share(0.04), &mut emissive);
    windows(kit, town, share(0.40));
    let placed = |kit: &Kit| kit.scene.lights.len();
    let mut room_for = count.saturating_sub(emissive_lights(&kit.scene) + placed(kit));
    let mut take = |kit: &mut Kit, lights: Vec<PlacedLight>, most: usize| {
        let n = lights.len().min(most).min(room_for);
        kit.scene.lights.extend(&lights[..n]);
        room_for -= n;
        n
    };
    let lamps: Vec<PlacedLight> = town.lamps.iter().map(Lamp::light).collect();
    let lit = take(kit, lamps, share(0.35));
    stand_lamps(kit, town, lit);
    take(kit, floodlights(town), share(0.005).max(usize::from(count > 100)));
    mount_floodlights(kit, town);
    take(kit, [room_lights(&town.plan), square::lights()].concat(), share(0.1));
    let garlands: Vec<Garland> = garlands::garlands(&town.plan, &town.trees, &town.lots, &town.designs);
    let rest = room_for;
    let fairy = garlands::add(kit, &garlands, rest);
    kit.scene.lights.extend(fairy);
}

/// Lights that triangles may still become.
struct Emissive {
    left: usize,
}

impl Emissive {
    /// Takes the triangles of `part`, if they are at most `most`.
    fn fits(&mut self, most: usize, part: &Part) -> bool {
        let lights = part.triangles();
        let fits = lights <= most.min(self.left);
        self.left -= if fits { lights } else { 0 };
        fits
    }
}

/// Lights that the scene's emissive triangles and textures give.
pub fn emissive_lights(scene: &SceneDescription) -> usize {
    let emitters = Emitters::new(scene);
    let of_mesh = |mesh: usize| -> usize {
        let primitives = scene.meshes[mesh].primitives.iter().zip(&emitters.0[mesh]);
        primitives
            .map(|(primitive, emission)| match emission {
                None => 0,
                Some(Emission::Even(_)) => primitive.indices.len() / 3,
                Some(Emission::Textured(parts)) => parts.len(),
            })
            .sum()
    };
    let of_meshes: Vec<usize> = (0..scene.meshes.len()).map(of_mesh).collect();
    scene.instances.iter().map(|instance| of_meshes[instance.mesh]).sum()
}

/// Cars with four lamps each; the first lights of the scene are theirs.
fn moving_cars(kit: &mut Kit, town: &Town, most: usize) {
    let meshes = cars::COLORS.map(|color| kit.mesh(&format!("moving-{color:?}"), cars::mesh(color, true)));
    for round in traffic::rounds(&town.plan).iter().take(most) {
        let place = |time: f32| {
            let at = round.at(time);
            (Vec3::new(at.x, 0.0, at.y), round.way(time))
        };
        let animation = &mut kit.scene.animation;
        let node = traffic::follow(animation, place);
        animation.attached.push((Thing::Instance(kit.scene.instances.len()), node));
        let (at, way) = place(0.0);
        let rest = Affine3A::from_rotation_translation(cars::heading(way), at);
        kit.place(meshes[round.color], rest);
        for (position, turn, spot) in cars::lamps() {
            let light = Thing::Light(kit.scene.lights.len());
            traffic::attach(&mut kit.scene.animation, light, node, position, turn);
            kit.scene.lights.push(cars::placed(&spot, &rest));
        }
    }
    let camera = kit.scene.cameras.iter().position(|camera| camera.name == "drive");
    if let Some(camera) = camera {
        let drive = traffic::drive();
        let node = traffic::follow(&mut kit.scene.animation, |time| traffic::driver(&drive, time));
        kit.scene.animation.attached.push((Thing::Camera(camera), node));
    }
}

/// Words over shops, near the square first.
fn neon(kit: &mut Kit, town: &Town, most: usize, emissive: &mut Emissive) {
    let mut left = most;
    let words: Vec<Part> = signs::WORDS.iter().map(|&(text, finish)| signs::word(text, finish)).collect();
    let meshes: Vec<usize> = (words.iter().zip(signs::WORDS))
        .map(|(part, (text, _))| kit.mesh(&format!("neon-{text}"), part.clone()))
        .collect();
    let shops = town.lots.iter().filter(|lot| town.designs[lot.design].shop.is_some());
    for (i, lot) in shops.enumerate() {
        let word = (i * 5 + lot.block) % words.len();
        let lights = glow::shining(&kit.scene, meshes[word]);
        if left < lights || emissive.left < lights {
            break;
        }
        (left, emissive.left) = (left - lights, emissive.left - lights);
        // Not stretched, not mirrored.
        let foot = lot.transform.translation;
        kit.place(meshes[word], lots::standing(glam::Vec2::new(foot.x, foot.z), lot.side, Vec3::ONE));
    }
}

/// Posters at the kerbs of avenues; cases stand there in any case.
fn posters(kit: &mut Kit, town: &Town, most: usize, emissive: &mut Emissive) {
    let case = kit.mesh("poster-case", signs::case());
    let meshes: Vec<usize> = (0..super::textures::POSTERS)
        .map(|i| {
            let mesh = kit.mesh(&format!("poster-{i}"), signs::poster());
            kit.scene.meshes[mesh].primitives[0].material += i;
            mesh
        })
        .collect();
    let cases = signs::cases(&town.plan);
    for (_, place) in &cases {
        kit.place(case, *place);
    }
    // Each of them once, to see what it costs.
    let alone = |mesh: usize| {
        let instance = Instance { name: String::new(), mesh: 0, transform: Affine3A::IDENTITY };
        emissive_lights(&SceneDescription {
            meshes: vec![kit.scene.meshes[mesh].clone()],
            instances: vec![instance],
            materials: kit.scene.materials.clone(),
            textures: kit.scene.textures.clone(),
            ..SceneDescription::default()
        })
    };
    let costs: Vec<usize> = meshes.iter().map(|&mesh| alone(mesh)).collect();
    let mut left = most.min(emissive.left);
    for (i, place) in cases {
        if costs[i] > left {
            break;
        }
        left -= costs[i];
        emissive.left -= costs[i];
        kit.place(meshes[i], place);
    }
}

fn windows(kit: &mut Kit, town: &Town, budget: usize) {
    let houses: Vec<Glows> = (town.designs.iter().enumerate())
        .map(|(i, house)| {
            Glows::new(kit, &format!("house-{i}"), &house.panes, house.shop.as_ref(), glow::OF_HOUSES)
        })
        .collect();
    let towers: Vec<Glows> = (town.towers.iter().enumerate())
        .map(|(i, tower)| Glows::new(kit, &format!("tower-{i}"), &tower.panes, None, glow::OF_TOWERS))
        .collect();
    let hall = Glows::new(kit, "town-hall", &town.hall, None, glow::OF_HOUSES);
    let mut buildings: Vec<(f32, &Glows, Affine3A)> = Vec::new();
    buildings.push((0.0, &hall, Affine3A::from_translation(Vec3::Y * KERB)));
    buildings.extend(town.lots.iter().map(|lot| (lot.distance(), &houses[lot.design], lot.transform)));
    buildings.extend(
        town.sites.iter().map(|site| (site.rect.center().length(), &towers[site.design], site.transform)),
    );
    buildings.sort_by(|a, b| a.0.total_cmp(&b.0));
    let glows: Vec<&Glows> = buildings.iter().map(|building| building.1).collect();
    let levels = glow::levels(&glows, budget);
    for (i, (level, (_, glow, place))) in levels.iter().zip(&buildings).enumerate() {
        if let Some(level) = level {
            kit.place(glow.mesh(*level, i), *place);
        }
    }
}

/// The first `lit` lamps shine, the others are there.
fn stand_lamps(kit: &mut Kit, town: &Town, lit: usize) {
    let mesh = |kit: &mut Kit, kind, lit| kit.mesh(&format!("lamp-{kind:?}-{lit}"), lamps::mesh(kind, lit));
    let on = [Kind::Lantern, Kind::Mast].map(|kind| mesh(kit, kind, true));
    let off = [Kind::Lantern, Kind::Mast].map(|kind| mesh(kit, kind, false));
    for (i, lamp) in town.lamps.iter().enumerate() {
        let of = if i < lit { on } else { off };
        kit.place(of[lamp.kind as usize], lamp.transform());
    }
}

fn floodlights(town: &Town) -> Vec<PlacedLight> {
    let mut lights = Vec::new();
    for i in 0..3 {
        for site in &town.sites {
            let (position, axis) = site.floodlights(&town.towers[site.design])[i];
            let [inner_angle, outer_angle] = FLOODED;
            let intensity = Vec3::new(0.93, 1.0, 1.12) * FLOOD;
            lights
                .push(SpotLight { position, axis, intensity, inner_angle, outer_angle, radius: 0.0 }.into());
        }
    }
    lights
}

fn mount_floodlights(kit: &mut Kit, town: &Town) {
    // The light is before the case's front.
    let case = Part::of(Finish::Iron, cuboid(Vec3::new(-0.35, -0.25, 0.06), Vec3::new(0.35, 0.25, 0.5)))
        .with(Finish::Iron, cuboid(Vec3::new(-0.06, -1.1, 0.2), Vec3::new(0.06, -0.25, 0.32)))
        .with(Finish::WhiteBulb, cuboid(Vec3::new(-0.3, -0.2, 0.04), Vec3::new(0.3, 0.2, 0.06)));
    let mesh = kit.mesh("floodlight", case);
    for site in &town.sites {
        for (position, axis) in site.floodlights(&town.towers[site.design]) {
            let side = axis.cross(Vec3::Y).normalize();
            let turn = Quat::from_mat3(&Mat3::from_cols(side, side.cross(axis), -axis));
            kit.place(mesh, Affine3A::from_rotation_translation(turn, position));
        }
    }
}

fn room_lights(plan: &Plan) -> Vec<PlacedLight> {
    let Some(place) = room::transform(plan) else { return Vec::new() };
    let light = |(p, intensity): (Vec3, f32)| {
        let position = place.transform_point3(p);
        PlacedLight::from(PointLight {
            position,
            intensity: Vec3::new(1.3, 0.95, 0.5) * intensity,
            radius: 0.0,
        })
    };
    room::LIGHTS.map(light).to_vec()
}
