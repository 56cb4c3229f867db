"""A plate of rubber hangs by one corner and falls from rest: the pendulum of Dufva and Shabana (2005)."""

import ancf

rubber = ancf.Material(E=1e5, nu=0.3, density=7810.0)
plate = ancf.Rectangle(size=(0.3, 0.3), divisions=(8, 8), thickness=0.01, material=rubber, membrane="full")
model = ancf.Model(
    bodies={"plate": plate},
    supports=[ancf.Support(at="corner:x0y0", fix=["r"])],
    loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
    probes=[ancf.Probe(name="A", at=(0.3, 0.3)), ancf.Probe(name="B", at=(0.15, 0.15))],
)

result = ancf.simulate(model, until=0.3, step=1e-3, method="hht", alpha=-0.05, every=0.05)

for name, record in result.probes.items():
    for t, (x, y, z) in zip(record.t, record.value, strict=True):
        print(f"{name}   t = {t:4.2f} s   {x:9.5f} {y:9.5f} {z:9.5f} m")

# The NumPy path (ancf.reference) gives x = y = 0.23272 and z = -0.43762 for the same mesh, step and method.
x, y, z = result.probes["A"].value[-1]
assert abs(x - 0.23272) < 1e-5
assert abs(x - y) < 1e-6
assert abs(z - -0.43762) < 1e-5
