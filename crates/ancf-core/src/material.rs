//! Material laws: the constant stiffness between strain and stress components.

use crate::error::InputError;
use crate::strain::{SOLID_PAIRS, SURFACE_PAIRS};

/// A homogeneous, isotropic, linear elastic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    young: f64,
    poisson: f64,
    density: f64,
    damping: Damping,
}

/// Linear damping of a material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// Force `mass M v`, 1/s.
    pub mass: f64,
    /// Kelvin-Voigt: stress `viscosity W d(eps)/dt` beside the elastic one, s.
    pub viscosity: f64,
}

impl Material {
    /// A material from Young's modulus (Pa), Poisson's ratio and density (kg/m3).
    ///
    /// # Errors
    ///
    /// Young's modulus must be from 1e-30 to 1e30 Pa, Poisson's ratio above -1 and below 0.5, the density not negative
    /// (zero is enough for statics).
    ///
    /// # Examples
    ///
    /// ```
    /// use ancf_core::Material;
    /// assert!(Material::new(2.07e11, 0.3, 7810.0).is_ok());
    /// assert_eq!(Material::new(2.07e11, 0.5, 7810.0).unwrap_err().argument, "nu");
    /// ```
    pub fn new(young: f64, poisson: f64, density: f64) -> Result<Self, InputError> {
        InputError::check("E", young, (1e-30..=1e30).contains(&young), "from 1e-30 to 1e30, Pa")?;
        InputError::check("nu", poisson, poisson > -1.0 && poisson < 0.5, "above -1 and below 0.5")?;
        InputError::check(
            "density",
            density,
            density >= 0.0 && density.is_finite(),
            "zero or a positive number, kg/m3",
        )?;
        Ok(Self { young, poisson, density, damping: Damping::default() })
    }

    /// The same material with damping.
    ///
    /// # Errors
    ///
    /// Both numbers must be finite and not negative.
    pub fn with_damping(self, damping: Damping) -> Result<Self, InputError> {
        let valid = |x: f64| x >= 0.0 && x.is_finite();
        InputError::check("mass_damping", damping.mass, valid(damping.mass), "zero or a positive number, 1/s")?;
        InputError::check("viscosity", damping.viscosity, valid(damping.viscosity), "zero or a positive number, s")?;
        Ok(Self { damping, ..self })
    }

    /// The damping.
    pub fn damping(&self) -> Damping {
        self.damping
    }

    /// Density, kg/m3.
    pub fn density(&self) -> f64 {
        self.density
    }

    /// The same with this density, kg/m3, if it has none.
    pub(crate) fn with_density_where_none(self, density: f64) -> Self {
        Self { density: if self.density == 0.0 { density } else { self.density }, ..self }
    }

    /// The plane-stress stiffness (Pa) for covariant strain components `xx`, `yy`, doubled `xy`, measured in
    /// coordinates with the contravariant metric `[a^xx, a^yy, a^xy]`.
    ///
    /// In an orthonormal frame, metric `[1, 1, 0]`, this is `E / (1 - nu^2) [[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu)/2]]`.
    ///
    /// # Source
    ///
    /// Dufva and Shabana (2005), (28).
    pub fn plane_stress(&self, [xx, yy, xy]: [f64; 3]) -> [[f64; 3]; 3] {
        let lambda = self.young * self.poisson / (1.0 - self.poisson * self.poisson);
        isotropic(lambda, self.shear(), [[xx, xy], [xy, yy]], SURFACE_PAIRS)
    }

    /// Hooke's stiffness (Pa) for covariant strain components `xx`, `yy`, `zz` and doubled `yz`, `xz`, `xy`, measured in
    /// coordinates with the given contravariant metric.
    ///
    /// # Source
    ///
    /// Dufva and Shabana (2005), (14).
    pub fn hooke(&self, metric: [[f64; 3]; 3]) -> [[f64; 6]; 6] {
        let lambda = self.young * self.poisson / ((1.0 + self.poisson) * (1.0 - 2.0 * self.poisson));
        isotropic(lambda, self.shear(), metric, SOLID_PAIRS)
    }

    /// Strain across a plate in plane stress, from the sum of the two strains in its plane.
    pub(crate) fn strain_across(&self, sum: f64) -> f64 {
        -self.poisson / (1.0 - self.poisson) * sum
    }

    /// The shear modulus, Pa.
    fn shear(&self) -> f64 {
        0.5 * self.young / (1.0 + self.poisson)
    }
}

/// The tensor `lambda a^ij a^kl + mu (a^ik a^jl + a^il a^jk)` for pairs `ij`, `kl` of indices.
fn isotropic<const DIM: usize, const C: usize>(
    lambda: f64,
    mu: f64,
    a: [[f64; DIM]; DIM],
    pairs: [(usize, usize); C],
) -> [[f64; C]; C] {
    pairs.map(|(i, j)| pairs.map(|(k, l)| lambda * a[i][j] * a[k][l] + mu * (a[i][k] * a[j][l] + a[i][l] * a[j][k])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plane_stress_in_an_orthonormal_frame() {
        let d = Material::new(2.0, 0.25, 1.0).unwrap().plane_stress([1.0, 1.0, 0.0]);
        let scale = 2.0 / (1.0 - 0.0625);
        let expected = [[1.0, 0.25, 0.0], [0.25, 1.0, 0.0], [0.0, 0.0, 0.375]];
        for i in 0..3 {
            for j in 0..3 {
                assert!((d[i][j] - scale * expected[i][j]).abs() < 1e-15);
            }
        }
    }

    /// Half the strain energy of a given strain tensor does not depend on the coordinates it is measured in.
    #[test]
    fn plane_stress_is_a_tensor() {
        let material = Material::new(3.0, 0.3, 1.0).unwrap();
        // Coordinates x' with dx = F dx': covariant components E' = F^T E F, metric a' = F^T F.
        let f = [[1.2, 0.4], [-0.3, 0.9]];
        let e = [[0.02, 0.01], [0.01, -0.03]];
        let pull = |m: [[f64; 2]; 2]| {
            let mut out = [[0.0; 2]; 2];
            for (i, row) in out.iter_mut().enumerate() {
                for (j, entry) in row.iter_mut().enumerate() {
                    for k in 0..2 {
                        for l in 0..2 {
                            *entry += f[k][i] * m[k][l] * f[l][j];
                        }
                    }
                }
            }
            out
        };
        let energy = |metric: [f64; 3], e: [[f64; 2]; 2]| {
            let d = material.plane_stress(metric);
            let v = [e[0][0], e[1][1], 2.0 * e[0][1]];
            (0..3).map(|i| (0..3).map(|j| v[i] * d[i][j] * v[j]).sum::<f64>()).sum::<f64>()
        };
        let a = pull([[1.0, 0.0], [0.0, 1.0]]);
        let det = a[0][0] * a[1][1] - a[0][1] * a[0][1];
        let inverse = [a[1][1] / det, a[0][0] / det, -a[0][1] / det];
        let difference = energy(inverse, pull(e)) - energy([1.0, 1.0, 0.0], e);
        assert!(difference.abs() < 1e-15, "{difference}");
    }
}
