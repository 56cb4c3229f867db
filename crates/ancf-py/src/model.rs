//! Models: bodies, supports, loads; and what the tests look at.

use std::sync::{Arc, Mutex, PoisonError};

use ancf_core::assembly::System;
use ancf_core::element::{Kind, Membrane, Want};
use ancf_core::evaluate::{MaterialPoint, Quantity};
use ancf_core::model::{Course, Load, LoadKind, Plate, SupportMotion};
use ancf_core::strain::CurvatureLaw;
use ancf_core::{Damping, InputError, Material, model};
use numpy::{PyArray1, PyArray2, PyArray3, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arguments::{At, Factors, fixes, named};
use crate::arrays::{coordinates, matrix, stack, states, vector};
use crate::errors::checked;
use crate::shape::Shape;

/// Bodies, supports and loads.
#[pyclass(module = "ancf._core")]
#[derive(Default)]
pub struct Model {
    model: Arc<model::Model>,
    /// Made when it is first needed, dropped when the model changes.
    system: Mutex<Option<System>>,
}

/// A point of an axis, its direction, and rows [t, angle].
type Turn = ([f64; 3], [f64; 3], Vec<[f64; 2]>);
/// Rows, columns and values of a sparse matrix.
type Triplets<'py> = (Bound<'py, PyArray1<u64>>, Bound<'py, PyArray1<u64>>, Bound<'py, PyArray1<f64>>);

impl Model {
    /// The model as the core knows it.
    pub fn core(&self) -> Arc<model::Model> {
        Arc::clone(&self.model)
    }

    fn edit(&mut self) -> &mut model::Model {
        *self.system.get_mut().unwrap_or_else(PoisonError::into_inner) = None;
        Arc::make_mut(&mut self.model)
    }

    fn with_system<T>(&self, use_it: impl FnOnce(&mut System) -> T) -> PyResult<T> {
        let mut system = self.system.lock().unwrap_or_else(PoisonError::into_inner);
        let system = match &mut *system {
            Some(system) => system,
            none => {
                let made = System::new(self.core()).map_err(|error| PyMemoryError::new_err(error.to_string()))?;
                none.insert(made)
            }
        };
        Ok(use_it(system))
    }

    fn add(&mut self, py: Python<'_>, kind: LoadKind, history: Factors) -> PyResult<()> {
        let history = history.history(py)?;
        checked(py, self.edit().add_load(Load { kind, history }))
    }
}

/// Values at times `t` of the smooth curve through rows `[t, value]` on which supports move.
#[pyfunction]
pub fn curve<'py>(
    py: Python<'py>,
    rows: PyReadonlyArray2<'_, f64>,
    t: PyReadonlyArray1<'_, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let rows = states(py, "rows", &rows, 2)?.iter().map(|row| [row[0], row[1]]).collect();
    let course = checked(py, Course::table("rows", rows))?;
    Ok(vector(py, t.as_array().iter().map(|t| course.at(*t)[0]).collect()))
}

#[pymethods]
impl Model {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    #[pyo3(signature = (name, shape, divisions, *, thickness, E, nu, density, mass_damping, viscosity, element, membrane, curvature))]
    #[expect(clippy::too_many_arguments, non_snake_case, reason = "keyword arguments in Python, named as in mechanics")]
    fn add_body(
        &mut self,
        py: Python<'_>,
        name: &str,
        shape: &Shape,
        divisions: [usize; 2],
        thickness: f64,
        E: f64,
        nu: f64,
        density: f64,
        mass_damping: f64,
        viscosity: f64,
        element: &str,
        membrane: Option<&str>,
        curvature: Option<&str>,
    ) -> PyResult<()> {
        let damping = Damping { mass: mass_damping, viscosity };
        let material = Material::new(E, nu, density).and_then(|material| material.with_damping(damping));
        let plate = Plate {
            material: checked(py, material)?,
            thickness,
            element: named(py, "element", element, &Kind::ALL, Kind::name)?,
            membrane: membrane.map(|name| named(py, "membrane", name, &Membrane::ALL, Membrane::name)).transpose()?,
            curvature: curvature
                .map(|name| named(py, "curvature", name, &CurvatureLaw::ALL, CurvatureLaw::name))
                .transpose()?,
        };
        checked(py, self.edit().add_body(name, &shape.0, divisions, plate)).map(|_| ())
    }

    fn fix(&mut self, py: Python<'_>, body: &str, at: At, coordinates: Vec<String>) -> PyResult<()> {
        let place = at.place(py)?;
        let id = checked(py, self.model.find(body))?;
        let fixes = fixes(py, &coordinates)?;
        checked(py, self.edit().fix(id, place, &fixes))
    }

    #[pyo3(signature = (body, at, coordinates, *, translation, shake, rotation))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
    fn move_support(
        &mut self,
        py: Python<'_>,
        body: &str,
        at: At,
        coordinates: Vec<String>,
        translation: Option<Vec<[f64; 4]>>,
        shake: Option<([f64; 3], f64)>,
        rotation: Option<Turn>,
    ) -> PyResult<()> {
        let place = at.place(py)?;
        let id = checked(py, self.model.find(body))?;
        let fixes = fixes(py, &coordinates)?;
        let mut motion = SupportMotion::default();
        for (axis, direction) in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into_iter().enumerate() {
            if let Some(rows) = &translation {
                let rows = rows.iter().map(|row| [row[0], row[axis + 1]]).collect();
                motion.translation.push((direction, checked(py, Course::table("translation", rows))?));
            }
        }
        if let Some((amplitude, frequency)) = shake {
            motion.translation.push((amplitude, Course::Sine { amplitude: 1.0, frequency }));
        }
        if let Some((point, axis, angle)) = rotation {
            motion.rotation = Some((point, axis, checked(py, Course::table("rotation.angle", angle))?));
        }
        checked(py, self.edit().move_support(id, place, &fixes, motion))
    }

    fn add_gravity(&mut self, py: Python<'_>, acceleration: [f64; 3], history: Factors) -> PyResult<()> {
        self.add(py, LoadKind::Gravity(acceleration), history)
    }

    fn add_force(&mut self, py: Python<'_>, body: &str, at: At, force: [f64; 3], history: Factors) -> PyResult<()> {
        let place = at.place(py)?;
        let body = checked(py, self.model.find(body))?;
        let point = checked(py, self.model.point_at(body, place))?;
        self.add(py, LoadKind::Force { body, point, force }, history)
    }

    fn add_line_load(
        &mut self,
        py: Python<'_>,
        body: &str,
        at: At,
        per_length: [f64; 3],
        history: Factors,
    ) -> PyResult<()> {
        let edge = checked(py, model::Model::edge_at(at.place(py)?))?;
        let body = checked(py, self.model.find(body))?;
        self.add(py, LoadKind::Line { body, edge, per_length }, history)
    }

    fn add_moment(&mut self, py: Python<'_>, body: &str, at: At, per_length: f64, history: Factors) -> PyResult<()> {
        let edge = checked(py, model::Model::edge_at(at.place(py)?))?;
        let body = checked(py, self.model.find(body))?;
        self.add(py, LoadKind::Moment { body, edge, per_length }, history)
    }

    fn add_pressure(&mut self, py: Python<'_>, body: &str, pressure: f64, history: Factors) -> PyResult<()> {
        let body = checked(py, self.model.find(body))?;
        self.add(py, LoadKind::Pressure { body, pressure }, history)
    }

    #[getter]
    fn coordinates(&self) -> usize {
        self.model.reference().len()
    }

    #[getter]
    fn dofs(&self) -> usize {
        self.model.fixed().iter().filter(|fixed| !**fixed).count()
    }

    #[getter]
    fn elements(&self) -> usize {
        self.model.bodies().iter().map(|body| body.grid().elements()).sum()
    }

    fn reference<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.model.reference().to_vec())
    }

    fn free<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        let free = self.model.fixed().iter().enumerate().filter(|(_, fixed)| !**fixed);
        vector(py, free.map(|(i, _)| i as u64).collect())
    }

    fn nodes<'py>(&self, py: Python<'py>, body: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let grid = self.model.body(checked(py, self.model.find(body))?).grid();
        Ok(matrix(py, 2, (0..grid.nodes()).flat_map(|node| grid.parameters(node)).collect()))
    }

    fn vectors<'py>(&self, py: Python<'py>, body: &str) -> PyResult<Bound<'py, PyArray2<u64>>> {
        let body = self.model.body(checked(py, self.model.find(body))?);
        let count = body.nodal_vectors().len();
        let first = |node: usize| (0..count).map(move |i| 3 * body.vector(node, i) as u64);
        Ok(matrix(py, count, (0..body.grid().nodes()).flat_map(first).collect()))
    }

    fn cells<'py>(&self, py: Python<'py>, body: &str) -> PyResult<Bound<'py, PyArray2<u64>>> {
        let grid = self.model.body(checked(py, self.model.find(body))?).grid();
        let nodes = (0..grid.elements()).flat_map(|element| grid.cell(element)).map(|node| node as u64);
        Ok(matrix(py, 4, nodes.collect()))
    }

    fn domain(&self, py: Python<'_>, body: &str) -> PyResult<((f64, f64), (f64, f64))> {
        let [x, y] = *self.model.body(checked(py, self.model.find(body))?).grid().domain();
        Ok((x.into(), y.into()))
    }

    fn rigid_motions(&self) -> Vec<(String, String)> {
        let motions = self.model.rigid_motions(self.model.reference());
        motions.iter().map(|motion| (motion.body.clone(), motion.describe())).collect()
    }

    fn energy(&self, py: Python<'_>, q: PyReadonlyArray1<'_, f64>) -> PyResult<(f64, f64)> {
        let q = coordinates(py, "q", &q, self.coordinates())?;
        let energy = self.with_system(|system| system.internal_force(&q, &mut vec![0.0; q.len()]))?;
        Ok((energy.membrane, energy.bending))
    }

    fn internal_force<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let q = coordinates(py, "q", &q, self.coordinates())?;
        let mut force = vec![0.0; q.len()];
        self.with_system(|system| system.internal_force(&q, &mut force))?;
        Ok(vector(py, force))
    }

    fn external_force<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'_, f64>,
        t: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let q = coordinates(py, "q", &q, self.coordinates())?;
        let mut force = vec![0.0; q.len()];
        self.with_system(|system| system.external_force(&q, t, &mut force))?;
        Ok(vector(py, force))
    }

    #[pyo3(signature = (q, t = 0.0, previous = None))]
    fn tangent<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'_, f64>,
        t: f64,
        previous: Option<PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<Triplets<'py>> {
        let q = coordinates(py, "q", &q, self.coordinates())?;
        let previous = previous.map(|p| coordinates(py, "previous", &p, self.coordinates())).transpose()?;
        let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
        self.with_system(|system| {
            let want = Want { mass: 0.0, stiffness: 1.0, previous: previous.as_deref() };
            system.assemble(&q, t, want, &mut vec![0.0; q.len()]);
            let (pattern, entries) = system.tangent();
            for column in 0..pattern.n() {
                let start = pattern.col_ptr()[column];
                for (k, &row) in pattern.rows(column).iter().enumerate() {
                    let (i, j) = (system.free()[row] as u64, system.free()[column] as u64);
                    rows.push(i);
                    columns.push(j);
                    values.push(entries[start + k]);
                    if i != j {
                        rows.push(j);
                        columns.push(i);
                        values.push(entries[start + k]);
                    }
                }
            }
        })?;
        Ok((vector(py, rows), vector(py, columns), vector(py, values)))
    }

    fn factorize(&self) -> PyResult<usize> {
        let inertia = self.with_system(System::factorize)?;
        inertia.map(|inertia| inertia.negative).map_err(|error| PyRuntimeError::new_err(error.to_string()))
    }

    fn solve<'py>(&self, py: Python<'py>, right: PyReadonlyArray1<'_, f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let right = coordinates(py, "right", &right, self.coordinates())?;
        let mut solution = vec![0.0; right.len()];
        self.with_system(|system| system.solve(&right, &mut solution))?;
        Ok(vector(py, solution))
    }

    fn mass<'py>(&self, py: Python<'py>) -> PyResult<Triplets<'py>> {
        let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
        self.with_system(|system| {
            let (pattern, entries) = (system.mass().pattern(), system.mass().values());
            for column in 0..pattern.n() {
                let start = pattern.col_ptr()[column];
                for (k, &row) in pattern.rows(column).iter().enumerate() {
                    for (i, j) in [(row, column), (column, row)].into_iter().take(1 + usize::from(row != column)) {
                        for c in 0..3 {
                            rows.push((3 * i + c) as u64);
                            columns.push((3 * j + c) as u64);
                            values.push(entries[start + k]);
                        }
                    }
                }
            }
        })?;
        Ok((vector(py, rows), vector(py, columns), vector(py, values)))
    }

    fn samples<'py>(&self, py: Python<'py>, body: &str, of: &str) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let body = self.model.body(checked(py, self.model.find(body))?);
        let [membrane, bending] = body.samples();
        let points = match of {
            "membrane" => membrane,
            "bending" => bending,
            _ => return checked(py, Err(InputError::new("of", format!("\"{of}\""), "membrane, bending"))),
        };
        let (grid, [l, w]) = (body.grid(), body.grid().element_sides());
        let place = |element: usize| {
            let [x, y] = grid.parameters(grid.cell(element)[0]);
            points.iter().flat_map(move |[xi, eta]| [x + l * xi, y + w * eta])
        };
        let values = (0..grid.elements()).flat_map(place).collect();
        Ok(stack(py, (grid.elements(), points.len(), 2), values))
    }

    fn locate(&self, py: Python<'_>, body: &str, points: PyReadonlyArray2<'_, f64>) -> PyResult<()> {
        let body = checked(py, self.model.find(body))?;
        for point in states(py, "points", &points, 2)? {
            checked(py, self.model.body(body).grid().locate([point[0], point[1]]))?;
        }
        Ok(())
    }

    #[pyo3(signature = (body, points, quantity, q, v = None))]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        body: &str,
        points: PyReadonlyArray2<'_, f64>,
        quantity: &str,
        q: PyReadonlyArray2<'_, f64>,
        v: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let body = checked(py, self.model.find(body))?;
        let quantity: Quantity = checked(py, quantity.parse())?;
        let points = states(py, "points", &points, 2)?;
        let q = states(py, "q", &q, self.coordinates())?;
        let v = v.map(|v| states(py, "v", &v, self.coordinates())).transpose()?;
        let rest = vec![0.0; self.coordinates()];
        if quantity == Quantity::Velocity && v.as_ref().is_none_or(|v| v.len() != q.len()) {
            return checked(py, Err(InputError::new("v", "missing or of another length", "as many states as q")));
        }
        let points: Vec<MaterialPoint> = points
            .iter()
            .map(|point| checked(py, MaterialPoint::new(&self.model, body, [point[0], point[1]], quantity)))
            .collect::<PyResult<_>>()?;
        let components = quantity.components();
        let at = |i: usize| {
            let v = v.as_ref().map_or(&rest, |v| &v[i]);
            let of_point = |point: &MaterialPoint| point.evaluate(&q[i], v).into_iter().take(components);
            points.iter().flat_map(of_point).collect::<Vec<f64>>()
        };
        let values: Vec<Vec<f64>> = py.detach(|| (0..q.len()).into_par_iter().map(at).collect());
        let values = values.concat();
        Ok(stack(py, (q.len(), points.len(), components), values))
    }
}
