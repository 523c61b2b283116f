//! Cameras from the command line: by name, by index, by position, or the first.

use super::animation::Thing;
use super::{SceneCamera, SceneDescription};
use crate::error::{Error, Result};
use glam::{DVec3, UVec2, Vec3};
use shared::camera::Camera;

impl SceneDescription {
    /// The camera of that name, number or position (`x,y,z,tx,ty,tz[,fov]`: m, degrees) where the scene has it now; without one, the
    /// first, or one fitted around the scene.
    pub fn camera(&self, text: Option<&str>) -> Result<SceneCamera> {
        match text {
            Some(text) => self.named_camera(text),
            None => Ok(self.cameras.first().cloned().unwrap_or_else(|| self.camera_fitted())),
        }
    }

    /// The camera of that name or number, if it moves.
    pub fn animated_camera(&self, text: &str) -> Result<SceneCamera> {
        let index = self.camera_index(text)?;
        let moves = |i: &usize| self.animation.moves(Thing::Camera(*i));
        if moves(&index) {
            return Ok(self.cameras[index].clone());
        }
        let moving: Vec<_> =
            (0..self.cameras.len()).filter(moves).map(|i| self.cameras[i].name.as_str()).collect();
        let known =
            if moving.is_empty() { "no camera moves".into() } else { format!("{} do", moving.join(", ")) };
        Err(Error::Usage(format!("--camera-path {text}: {}: this camera does not move ({known})", self.name)))
    }

    fn named_camera(&self, text: &str) -> Result<SceneCamera> {
        if let Some(numbers) = parse_view(text) {
            let (position, target, fov) = numbers?;
            if position == target {
                return Err(Error::Usage(format!("--camera {text}: position and target are the same point")));
            }
            let fov_y = fov.unwrap_or(50.0).clamp(1.0, 170.0).to_radians() as f32;
            let forward = (target - position).normalize().as_vec3();
            let position = (position - self.origin).as_vec3();
            return Ok(SceneCamera { name: text.into(), position, forward, up: Vec3::Y, fov_y });
        }
        Ok(self.cameras[self.camera_index(text)?].clone())
    }

    fn camera_index(&self, text: &str) -> Result<usize> {
        let by_name = self.cameras.iter().position(|camera| camera.name == text);
        let by_index = text.parse().ok().filter(|&i: &usize| i < self.cameras.len());
        by_name.or(by_index).ok_or_else(|| {
            let names: Vec<_> = self.cameras.iter().map(|camera| camera.name.as_str()).collect();
            let known = if names.is_empty() { "none".into() } else { names.join(", ") };
            Error::Usage(format!("{}: no camera '{text}' (it has {known})", self.name))
        })
    }
}

impl SceneCamera {
    /// For a picture of `size` pixels.
    pub fn seen_in(&self, size: UVec2) -> Camera {
        Camera::new(self.position, self.forward, self.up, self.fov_y, size)
    }
}

/// `x,y,z,tx,ty,tz[,fov]` as (position, target, fov in degrees), or none if it is not a list of numbers.
pub fn parse_view(text: &str) -> Option<Result<(DVec3, DVec3, Option<f64>)>> {
    let numbers: Vec<f64> = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    let finite = numbers.iter().all(|n| n.is_finite());
    match numbers[..] {
        [x, y, z, tx, ty, tz, ref fov @ ..] if finite && fov.len() <= 1 => {
            Some(Ok((DVec3::new(x, y, z), DVec3::new(tx, ty, tz), fov.first().copied())))
        }
        // A single number is a camera's index.
        [_] => None,
        _ => Some(Err(Error::Usage(format!("--camera {text}: expected x,y,z,tx,ty,tz[,fov]")))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_are_six_or_seven_numbers() {
        assert!(parse_view("nave").is_none() && parse_view("2").is_none());
        let (position, target, fov) = parse_view("1,2,3,4,5,6").unwrap().unwrap();
        assert_eq!((position.x, target.z, fov), (1.0, 6.0, None));
        assert_eq!(parse_view("1,2,3,4,5,6,50").unwrap().unwrap().2, Some(50.0));
        assert!(parse_view("1,2,3").unwrap().is_err() && parse_view("1,2,3,4,5,inf").unwrap().is_err());
    }
}
