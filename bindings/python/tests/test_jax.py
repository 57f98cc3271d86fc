"""A closed chain inside a JAX computation: values and gradients by the chain's own derivatives."""

from types import SimpleNamespace

import mechanim
import numpy as np
import pytest

jax = pytest.importorskip("jax")
jax.config.update("jax_enable_x64", True)
jnp = jax.numpy

SAMPLES = 40
NAMES = ["r", "L"]


@pytest.fixture(scope="module")
def crank():
    """The scene, and the slider's place at all samples as a function that JAX differentiates."""
    scene = mechanim.load("slider-crank")

    def solve(x):
        return scene.with_(**dict(zip(NAMES, map(float, x)))).solve(samples=SAMPLES)

    @jax.custom_vjp
    def place(x):
        shape = jax.ShapeDtypeStruct((SAMPLES,), jnp.float64)
        return jax.pure_callback(lambda x: solve(x)["h"], shape, x)

    def forward(x):
        return place(x), x

    def backward(x, cotangents):
        shape = jax.ShapeDtypeStruct((len(NAMES),), jnp.float64)
        pull = lambda x, c: solve(x).vjp({"h": np.asarray(c)}, NAMES)
        return (jax.pure_callback(pull, shape, x, cotangents),)

    place.defvjp(forward, backward)
    return SimpleNamespace(scene=scene, place=place)


def test_values_are_those_of_the_motion(crank):
    found = crank.place(jnp.array([40.0, 100.0]))
    assert np.array_equal(found, crank.scene.with_(r=40, L=100).solve(samples=SAMPLES)["h"])


def test_gradients_are_those_of_the_closed_form(crank):
    # h = r cos(phi) + sqrt(L^2 - r^2 sin(phi)^2), at the angles of the drive.
    phi = crank.scene.solve(samples=SAMPLES)["phi"]
    phi = np.radians(phi) if crank.scene.units["phi"] == "deg" else phi

    def closed(x):
        r, length = x
        return r * jnp.cos(phi) + jnp.sqrt(length**2 - (r * jnp.sin(phi)) ** 2)

    weights = np.linspace(-1.0, 2.0, SAMPLES)
    x = jnp.array([41.0, 97.0])
    own = jax.grad(lambda x: jnp.sin(crank.place(x) / 50) @ weights)(x)
    exact = jax.grad(lambda x: jnp.sin(closed(x) / 50) @ weights)(x)
    assert np.allclose(own, exact, rtol=1e-12, atol=1e-13)


def test_a_descent_finds_the_dimensions_again(crank):
    target = crank.place(jnp.array([42.0, 103.0]))
    misfit = jax.jit(jax.value_and_grad(lambda x: jnp.mean((crank.place(x) - target) ** 2)))
    x = jnp.array([40.0, 100.0])
    for _ in range(200):
        _, slope = misfit(x)
        x = x - 0.5 * slope
    assert np.abs(np.asarray(x) - [42.0, 103.0]).max() < 1e-3
