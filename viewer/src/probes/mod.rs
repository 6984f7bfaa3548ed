//! Probes: bounced light in the air, for what the bake does not know – moving, transparent, skinned, foreign objects.
//!
//! A grid of probes, each with the radiance that arrives there as spherical harmonics (nine coefficients by channel), and
//! with the planes of the surfaces around it, which tell whether a place is behind one of them.
//!
//! * [`grid`] – where the probes are;
//! * [`harmonics`] – the basis;
//! * [`caster`] – rays to the surfaces;
//! * [`rows`] – what senders give to each probe: a sparse operator, found once a file;
//! * [`hits`] – reflectance and emission at the rays' hits, from the textures on the GPU;
//! * [`fill`] – the operator applied to the senders' light on the GPU, whenever lights change;
//! * [`sample`] – irradiance at a place, from the probes around it.
//!
//! The rows are linear in the light, as the operator is: `L_p = Σ_j c_pj · sent_j`, c with nine numbers. Rays that meet
//! surfaces give the senders of the level whose supports fit the ray's width; rays that meet none give the sky's bin.
//!
//! Majercik et al. 2019, *Dynamic Diffuse Global Illumination with Ray-Traced Irradiance Fields*, keep mean distances
//! and their squares for visibility, which leak behind walls that are seen at a slant. Planes are exact for walls.

pub mod caster;
pub mod fill;
pub mod grid;
pub mod harmonics;
pub mod hits;
pub mod rows;
pub mod sample;
