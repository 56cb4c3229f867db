//! Thin flexible bodies that move and bend far, in the absolute nodal coordinate formulation (ANCF).
//!
//! # What flows where
//!
//! A user makes a [`model`]: bodies over [`mesh`]es of reference surfaces, with a [`Material`], an [`element`] type,
//! supports and loads. Everything is checked as it is added; what cannot be used is an [`InputError`].
//!
//! [`assembly`] turns the model into equations. It numbers the free coordinates, makes the sparsity pattern and the
//! mass matrix once, and evaluates forces and tangents. The mechanics sits in [`element`]: an energy
//! `1/2 (eps - eps_0)^T W (eps - eps_0)` over strain samples, from shape functions (`shape`), [`strain`] measures and
//! weights, several elements side by side in SIMD registers (`lanes`).
//!
//! [`linear`] factorises the tangent. [`nonlinear`] solves `c M (q - q*) + k (Q_k - Q_e) + p = 0` by Newton's method;
//! [`statics`] puts it into steps along a load path, [`dynamics`] into time steps, [`modes`] finds the frequencies of small
//! oscillations. All tell an [`observe::Observer`] what they reach and end with a [`report::Run`]. [`evaluate`] gives
//! positions, strains and stresses at material points.
//!
//! # Example
//!
//! ```
//! use std::sync::Arc;
//! use ancf_core::assembly::System;
//! use ancf_core::element::{Kind, Membrane};
//! use ancf_core::mesh::Surface;
//! use ancf_core::model::{History, Load, LoadKind, Model, Plate};
//! use ancf_core::strain::CurvatureLaw;
//! use ancf_core::{Material, statics};
//!
//! let plate = Plate {
//!     material: Material::new(2.07e11, 0.3, 7810.0)?,
//!     thickness: 0.001,
//!     element: Kind::Thin36,
//!     membrane: Some(Membrane::Projected),
//!     curvature: Some(CurvatureLaw::Paper),
//! };
//! let mut model = Model::new();
//! let strip = model.add_body("strip", &Surface::rectangle([0.5, 0.15])?, [4, 1], plate)?;
//! model.clamp(strip, "edge:x0".parse()?)?;
//! let edge = Model::edge_at("edge:x1".parse()?)?;
//! let kind = LoadKind::Line { body: strip, edge, per_length: [0.0, 0.0, -200.0] };
//! model.add_load(Load { kind, history: History::Ramp })?;
//!
//! let mut system = System::new(Arc::new(model))?;
//! let mut states = Vec::new();
//! statics::solve(&mut system, &statics::Options::default(), &mut states)?;
//! let tip = states.last().unwrap().q[9 * 4 + 2];
//! assert!((tip + 0.2847).abs() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub mod assembly;
pub mod dynamics;
pub mod element;
mod error;
pub mod evaluate;
mod lanes;
pub mod linear;
mod material;
pub mod mesh;
pub mod model;
pub mod modes;
pub mod nonlinear;
pub mod observe;
mod quadrature;
pub mod report;
mod shape;
pub mod statics;
pub mod strain;

pub use error::InputError;
pub use material::{Damping, Material};

/// The instruction set that the kernels use on this machine, and how many elements they evaluate side by side.
pub fn simd() -> (&'static str, usize) {
    struct Count;
    impl pulp::WithSimd for Count {
        type Output = usize;
        fn with_simd<S: pulp::Simd>(self, _: S) -> usize {
            S::F64_LANES
        }
    }
    let lanes = pulp::Arch::new().dispatch(Count);
    let name = match lanes {
        8 => "AVX-512",
        4 => "AVX2 and FMA",
        2 => "128-bit SIMD",
        _ => "scalar",
    };
    (name, lanes)
}
