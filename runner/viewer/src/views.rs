//! Views of a frame.

use candela::knobs::Step;
use shared::view::kind;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    Final,
    /// Every light of every pixel, accumulated.
    Reference,
    Difference,
    Distance,
    Normal,
    GeometricNormal,
    Diffuse,
    F0,
    Roughness,
    Instance,
    Features,
    Light,
    Weight,
    Confidence,
    Visibility,
    Cell,
    Believed,
}

impl View {
    pub const ALL: &[View] = &[
        View::Final,
        View::Reference,
        View::Difference,
        View::Distance,
        View::Normal,
        View::GeometricNormal,
        View::Diffuse,
        View::F0,
        View::Roughness,
        View::Instance,
        View::Features,
        View::Light,
        View::Weight,
        View::Confidence,
        View::Visibility,
        View::Cell,
        View::Believed,
    ];

    pub fn name(self) -> &'static str {
        match self {
            View::Final => "Final",
            View::Reference => "Reference",
            View::Difference => "Difference to the reference",
            View::Distance => "Distance",
            View::Normal => "Shading normal",
            View::GeometricNormal => "Geometric normal",
            View::Diffuse => "Diffuse albedo",
            View::F0 => "Specular F0",
            View::Roughness => "Roughness",
            View::Instance => "Instance",
            View::Features => "Features",
            View::Light => "Reservoir: light",
            View::Weight => "Reservoir: W",
            View::Confidence => "Reservoir: M",
            View::Visibility => "Visibility",
            View::Cell => "Light cells",
            View::Believed => "Believed visibility",
        }
    }

    /// What its colors mean.
    pub fn legend(self) -> &'static str {
        match self {
            View::Final | View::Reference => "",
            View::Difference => "blue: too dark by 50 % or more; black: equal; orange: too bright",
            View::Distance => "white near, black far, grey at the scene's radius",
            View::Normal | View::GeometricNormal => "red, green, blue: x, y, z from -1 to 1",
            View::Diffuse | View::F0 => "as the surface reflects",
            View::Roughness => "black smooth, white rough",
            View::Instance => "a color each",
            View::Features => "red: textures, green: normal map, blue: alpha, pale: emits",
            View::Light => "a color each; black: none",
            View::Weight => "2^-20 to 2^20; black: no light",
            View::Confidence => "1 to 65,536 candidates",
            View::Cell => {
                "a color each; pixels near an edge may use the neighboring cell; black without cells"
            }
            View::Believed => "0 to 1: visibility of the sample's light as believed by the pixel's cell",
            View::Visibility => "pale: lit by its sample; red: hidden; blue: no sample",
        }
    }

    /// As the shader counts them; none for the picture itself.
    pub fn kind(self) -> Option<u32> {
        match self {
            View::Final | View::Reference => None,
            View::Difference => Some(kind::DIFFERENCE),
            View::Distance => Some(kind::DISTANCE),
            View::Normal => Some(kind::NORMAL),
            View::GeometricNormal => Some(kind::GEOMETRIC_NORMAL),
            View::Diffuse => Some(kind::DIFFUSE),
            View::F0 => Some(kind::F0),
            View::Roughness => Some(kind::ROUGHNESS),
            View::Instance => Some(kind::INSTANCE),
            View::Features => Some(kind::FEATURES),
            View::Light => Some(kind::LIGHT),
            View::Weight => Some(kind::CONTRIBUTION_WEIGHT),
            View::Confidence => Some(kind::CONFIDENCE),
            View::Visibility => Some(kind::VISIBILITY),
            View::Cell => Some(kind::CELL),
            View::Believed => Some(kind::BELIEVED),
        }
    }

    /// Is it made with the reference?
    pub fn needs_reference(self) -> bool {
        matches!(self, View::Reference | View::Difference)
    }

    /// The next one or the one before, around and around.
    pub fn step(self, step: Step) -> View {
        let at = View::ALL.iter().position(|&v| v == self).unwrap_or(0);
        let count = View::ALL.len();
        View::ALL[if step == Step::Up { at + 1 } else { at + count - 1 } % count]
    }
}

/// What stands right of the divider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    Off,
    /// The second settings.
    Settings,
    Reference,
}

impl Split {
    pub const ALL: [Split; 3] = [Split::Off, Split::Settings, Split::Reference];

    pub fn name(self) -> &'static str {
        match self {
            Split::Off => "off",
            Split::Settings => "two settings",
            Split::Reference => "reference",
        }
    }

    pub fn next(self) -> Split {
        match self {
            Split::Off => Split::Settings,
            Split::Settings => Split::Reference,
            Split::Reference => Split::Off,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_view_is_reached_and_has_its_own_kind() {
        let mut view = View::Final;
        let mut kinds = HashSet::new();
        for _ in View::ALL {
            view = view.step(Step::Up);
            assert!(view.kind().is_none_or(|kind| kinds.insert(kind)), "{view:?}");
            assert_eq!(view.step(Step::Down).step(Step::Up), view);
        }
        assert_eq!((view, kinds.len()), (View::Final, View::ALL.len() - 2));
    }
}
