//! GPU entry points. Those of passes are written here by the tables of [`shared::resources`] and [`shared::passes`]: each loads what its
//! body asks for, runs the body, and stores what that gives. By hand stand those that know images or the hardware: [`hit`],
//! [`visibility`], [`primary`]. No arithmetic; rays are traced in [`trace`] and nowhere else.
#![cfg_attr(target_arch = "spirv", no_std)]
// An entry's arguments are its bindings.
#![allow(clippy::too_many_arguments)]

pub mod hit;
pub mod primary;
pub mod textures;
pub mod trace;
pub mod visibility;

use crate::textures::{Bound, Textures};
use crate::trace::{Eye, Nearest, Previous, Traced};
use shared::counters::Counters;
use shared::frame::FrameConstants;
use shared::glam::UVec3;
use shared::interface::{HitPayload, PassConstants, ShadowPayload};
use shared::passes::points::listed;
use shared::passes::{Assumed, At, Silent};
use shared::resources::Extent;
use shared::resources::element::*;
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::spirv;

/// The functions that entry points of the same names run.
mod body {
    pub use crate::primary::{gbuffer, gbuffer_aimed, gbuffer_kept, gbuffer_raster, roofline_primary};
    pub use shared::passes::*;
}

/// Defines `entry!`, which adds the parameters of one binding after the other to an entry point, and then writes it.
macro_rules! define_entry {
    ($(($set:tt $buffer:ident ($element:ty) $copies:literal $extent:ident { $($name:ident = $binding:tt),* }))*) => {
        entry_rules! { ($) $($($name $set $binding ($element))*)* }
    };
}

// `$d` stands for the dollar sign of the inner macro. Arguments: what is still to be read, updated, written and counted in; parameters,
// arguments of the body and stores so far; and the pass.
macro_rules! entry_rules {
    (($d:tt) $($name:ident $set:tt $binding:tt ($element:ty))*) => {
        macro_rules! entry {
            $(
            ([$name $d($read:ident)*] $update:tt $write:tt $count:tt [$d($params:tt)*] [$d($args:tt)*] $stores:tt $pass:tt) => {
                entry! { [$d($read)*] $update $write $count
                    [$d($params)* #[spirv(storage_buffer, descriptor_set = $set, binding = $binding)] $name: &[$element],]
                    [$d($args)* (read $name)] $stores $pass }
            };
            ([] [$name $d($update:ident)*] $write:tt $count:tt [$d($params:tt)*] [$d($args:tt)*] [$d($stores:ident)*] $pass:tt) => {
                entry! { [] [$d($update)*] $write $count
                    [$d($params)* #[spirv(storage_buffer, descriptor_set = $set, binding = $binding)] $name: &mut [$element],]
                    [$d($args)* (own $name)] [$d($stores)* $name] $pass }
            };
            ([] [] [$name $d($write:ident)*] $count:tt [$d($params:tt)*] $args:tt [$d($stores:ident)*] $pass:tt) => {
                entry! { [] [] [$d($write)*] $count
                    [$d($params)* #[spirv(storage_buffer, descriptor_set = $set, binding = $binding)] $name: &mut [$element],]
                    $args [$d($stores)* $name] $pass }
            };
            ([] [] [] [$name $d($count:ident)*] [$d($params:tt)*] [$d($args:tt)*] $stores:tt $pass:tt) => {
                entry! { [] [] [] [$d($count)*]
                    [$d($params)* #[spirv(storage_buffer, descriptor_set = $set, binding = $binding)] $name: &mut [$element],]
                    [$d($args)* (count $name)] $stores $pass }
            };
            )*
            ([textures $d($read:ident)*] $update:tt $write:tt $count:tt [$d($params:tt)*] [$d($args:tt)*] $stores:tt $pass:tt) => {
                entry! { [$d($read)*] $update $write $count
                    [$d($params)* #[spirv(descriptor_set = 0, binding = 32)] textures: &Textures,]
                    [$d($args)* (texels textures)] $stores $pass }
            };
            ([] [] [] [] $params:tt $args:tt $stores:tt $pass:tt) => {
                written! { $pass $params $args $stores }
            };
        }
    };
}

/// The entry point of a pass; what comes before its buffers hangs on how it runs.
macro_rules! written {
    (($body:ident $stem:ident $extent:ident compute) $params:tt $args:tt $stores:tt) => {
        function! { (compute(threads(32, 4, 1))) (global_invocation_id) id features [At::new: id] []
            $stem $extent $body [] $params $args $stores }
    };
    (($body:ident $stem:ident $extent:ident known) $params:tt $args:tt $stores:tt) => {
        function! { (compute(threads(32, 4, 1))) (global_invocation_id) id features [At::new: id] []
            $stem $extent $body [Assumed, Silent,] $params $args $stores }
    };
    (($body:ident $stem:ident $extent:ident known scene) $params:tt $args:tt $stores:tt) => {
        written! { ($body $stem $extent known) $params $args $stores }
    };
    (($body:ident $stem:ident $extent:ident traced scene shadow) $params:tt $args:tt $stores:tt) => {
        written! { ($body $stem $extent traced shadow) $params $args $stores }
    };
    (($body:ident $stem:ident $extent:ident primary) $params:tt $args:tt $stores:tt) => {
        function! { (ray_generation) (launch_id) id features [At::new: id]
            [#[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
            #[spirv(ray_payload)] payload: &mut HitPayload,]
            $stem $extent $body [Eye { tlas, payload },] $params $args $stores }
    };
    (($body:ident $stem:ident $extent:ident traced shadow) $params:tt $args:tt $stores:tt) => {
        function! { (ray_generation) (launch_id) id features [At::new: id]
            [#[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
            #[spirv(ray_payload)] payload: &mut ShadowPayload,]
            $stem $extent $body [Traced { features, tlas, payload }, Silent,] $params $args $stores }
    };
    (($body:ident $stem:ident $extent:ident traced shadow nearest) $params:tt $args:tt $stores:tt) => {
        written! { ($body $stem $extent traced shadow nearest by At::new) $params $args $stores }
    };
    (($body:ident $stem:ident $extent:ident traced shadow nearest by $at:path) $params:tt $args:tt $stores:tt) => {
        function! { (ray_generation) (launch_id) id features [$at: id]
            [#[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
            #[spirv(ray_payload)] payload: &mut ShadowPayload,
            #[spirv(ray_payload)] nearest: &mut HitPayload,]
            $stem $extent $body [Nearest { features, tlas, payload, nearest }, Silent,] $params $args $stores }
    };
    (($body:ident $stem:ident $extent:ident listed shadow) $params:tt [(read $list:ident) $($args:tt)*] $stores:tt) => {
        function! { (ray_generation) (launch_id) id features [At::new: listed($list, id, size)]
            [#[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
            #[spirv(ray_payload)] payload: &mut ShadowPayload,
            #[spirv(launch_size)] size: UVec3,]
            $stem $extent $body [Traced { features, tlas, payload }, Silent,] $params [$($args)*] $stores }
    };
    (($body:ident $stem:ident $extent:ident sparse) $params:tt $args:tt $stores:tt) => {
        written! { ($body $stem $extent traced shadow nearest by At::picked) $params $args $stores }
    };
    (($body:ident $stem:ident $extent:ident bounced) $params:tt $args:tt $stores:tt) => {
        written! { ($body $stem $extent traced shadow nearest) $params $args $stores }
    };
    (($body:ident $stem:ident $extent:ident traced shadow previous) $params:tt $args:tt $stores:tt) => {
        function! { (ray_generation) (launch_id) id features [At::new: id]
            [#[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
            #[spirv(descriptor_set = 2, binding = 0)] previous_tlas: &AccelerationStructure,
            #[spirv(ray_payload)] payload: &mut ShadowPayload,]
            $stem $extent $body [Previous { features, tlas, previous_tlas, payload }, Silent,] $params $args $stores }
    };
}

macro_rules! function {
    (($($stage:tt)*) ($launch:ident) $id:ident $features:ident [$at:path: $thread:expr] [$($start:tt)*] $stem:ident $extent:ident $body:ident
        [$($context:expr,)*] [$($params:tt)*] [$(($access:ident $arg:ident))*] $stores:tt) => {
        #[spirv($($stage)*)]
        pub fn $stem(
            #[spirv($launch)] $id: UVec3,
            #[spirv(spec_constant(id = 0, default = 0))] $features: u32,
            #[spirv(spec_constant(id = 1, default = 0))] variant: u32,
            #[spirv(push_constant)] constants: &PassConstants,
            #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
            $($start)*
            $($params)*
        ) {
            let at = $at(frame, *constants, $features, variant, $thread);
            if at.pixel.cmpge(at.threads(Extent::$extent)).any() {
                return;
            }
            let index = at.index(Extent::$extent);
            store!($stores index, body::$body(at, $($context,)* $(argument!($access $arg index),)*));
        }
    };
}

/// What a body gets of a buffer: all of it, or this thread's own element.
macro_rules! argument {
    (read $name:ident $index:ident) => {
        $name
    };
    (texels $name:ident $index:ident) => {
        Bound($name)
    };
    (own $name:ident $index:ident) => {
        $name[$index]
    };
    (count $name:ident $index:ident) => {
        Counters::new($name)
    };
}

macro_rules! store {
    ([] $index:ident, $value:expr) => { let _ = $index; $value; };
    ([$out:ident] $index:ident, $value:expr) => { $out[$index] = $value; };
    ([$($out:ident)*] $index:ident, $value:expr) => { ($($out[$index]),*) = $value; };
}

macro_rules! entries {
    ($(($body:ident $extent:ident { $($stage:ident($($rays:ident)*) $stem:ident),* }
        $read:tt $update:tt $write:tt $([$($count:ident)*])?))*) => {
        $(entries_of! { $body $extent [$($stage($($rays)*) $stem)*] $read $update $write [$($($count)*)?] })*
    };
}

macro_rules! entries_of {
    ($body:ident $extent:ident [] $read:tt $update:tt $write:tt $count:tt) => {};
    ($body:ident $extent:ident [drawn() $stem:ident] $read:tt $update:tt $write:tt $count:tt) => {};
    ($body:ident $extent:ident [$stage:ident($($rays:ident)*) $stem:ident $($more:tt)*] $read:tt $update:tt $write:tt $count:tt) => {
        entry! { $read $update $write $count [] [] [] ($body $stem $extent $stage $($rays)*) }
        entries_of! { $body $extent [$($more)*] $read $update $write $count }
    };
}

shared::resources!(define_entry);
shared::passes!(entries);
