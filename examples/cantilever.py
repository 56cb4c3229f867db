"""A thin plate of steel, clamped at one end, bends far: the cantilever of Dufva and Shabana (2005).

The paper loads it with two force components at the free end, F = 30 N. Here that is 30 N in all, spread evenly over the
edge and pointing down: 30 N / 0.15 m = 200 N/m.
"""

import ancf

steel = ancf.Material(E=2.07e11, nu=0.3, density=7810.0)
model = ancf.Model(
    bodies={"plate": ancf.Rectangle(size=(0.5, 0.15), divisions=(4, 1), thickness=0.001, material=steel)},
    supports=[ancf.Support(at="edge:x0", clamp=True)],
    loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -200.0))],
    probes=[ancf.Probe(name="corner", at=(0.5, 0.15), quantity="displacement")],
)

result = ancf.solve_static(model, load_factors=[0.25, 0.5, 0.75, 1.0])

for factor, (x, y, z) in zip(result.t, result.probes["corner"].value, strict=True):
    print(f"load factor {factor:4.2f}   displacement of the corner {x:9.5f} {y:9.5f} {z:9.5f} m")

# Independent prototype, 4 x 1 elements; a fine mesh, 16 x 4, gives -0.286.
assert abs(result.probes["corner"].value[-1, 2] - -0.2847) < 5e-5
