//! In place of exact faces where the crate is built without its feature `exact-faces`: there are none, and the compiler
//! leaves out what is for them.

use super::mesh::geometry::Surface;
use super::{Hit, Ray};
use crate::scene::brep::Brep;
use glam::Vec3;
use std::sync::Arc;

/// No surfaces.
pub enum NoFaces {}

pub use NoFaces as BrepSurfaces;

impl NoFaces {
    pub fn new(_: &Arc<Brep>, _: &[bool], _: f32) -> Option<Self> {
        None
    }

    pub fn piece_count(&self) -> usize {
        match *self {}
    }

    pub fn nearest(&self, _: &[Surface], _: &Ray, _: bool) -> Option<Hit> {
        match *self {}
    }

    pub fn is_hidden(&self, _: Vec3, _: Vec3, _: f32) -> bool {
        match *self {}
    }
}
