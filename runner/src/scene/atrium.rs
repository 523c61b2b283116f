//! (to come)
pub fn atrium(_lights: usize) -> super::SceneDescription {
    super::SceneDescription::default()
}
