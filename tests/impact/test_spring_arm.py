"""The elastic model against an integrator that shares no code with it, and in its limits."""

import numpy as np
import pytest

from benchmarks.elastic import energy_grows
from hitjoints.impact.elastic import pair_spring
from hitjoints.impact.restitution import contact_spring, restitution_of
from hitjoints.impact.spring_arm import second_contact
from tests.oracles.spring_arms import LONGEST, integrate, random_case


@pytest.fixture
def random():
    return np.random.default_rng(11)


def collide(case):
    parted = case.arm.collide(case.m, case.v, (case.k, case.d), case.time)
    speed = parted.impulse / case.m
    return parted, speed, speed + parted.closing


def agree(cases, steps):
    for case, judged in zip(cases, integrate(cases, steps=steps).T, strict=True):
        parted, object_speed, robot_speed = collide(case)
        if np.isnan(judged[0]):
            assert parted.time is None or parted.time > LONGEST * case.time
            continue
        assert parted.time == pytest.approx(judged[0], rel=1e-6)
        assert object_speed == pytest.approx(judged[1], rel=1e-6)
        assert robot_speed == pytest.approx(judged[2], abs=1e-4 * case.v)


@pytest.mark.parametrize("servo", [False, True])
def test_as_the_integrator(random, servo):
    agree([random_case(random, servo=servo) for _ in range(30)], 2000)


@pytest.mark.parametrize("servo", [False, True])
def test_an_arm_that_is_bent_by_its_own_motion(random, servo):
    cases = [random_case(random, servo=servo) for _ in range(15)]
    for case in cases:
        case.own = random.normal(0, 3.0, 7)
        case.bend = random.normal(0, 1.0)
        if servo:
            case.Kp[random.integers(0, 2, 7) == 0] = 0.0  # servos of velocity alone, too
    agree(cases, 2000)


def test_light_links_and_stiff_joints(random):
    cases = [random_case(random, stiffest=7, lightest=-3) for _ in range(10)]
    for case in cases:
        case.M[-1], case.M[:, -1] = 0.0, 0.0
        case.M[-1, -1], case.K[-1] = 1e-3, 1e7
        case.time = 60 / case.fastest
        case.k, case.d = pair_spring(case.arm.mobility, case.m, 0.6, case.time)
    agree(cases, 3000)


@pytest.mark.parametrize("restitution", [0.3, 0.7, 1.0])
def test_a_short_contact_shows_the_links_alone(random, restitution):
    for _ in range(20):
        case = random_case(random, restitution=restitution)
        case.time = 1e-4 / case.fastest
        case.k, case.d = pair_spring(case.arm.mobility, case.m, restitution, case.time)
        parted, speed, robot = collide(case)
        inertia = 1 / case.arm.mobility
        flux = inertia / (inertia + case.m) * case.v
        assert parted.time == pytest.approx(case.time, rel=1e-5)
        assert speed == pytest.approx((1 + restitution) * flux, rel=1e-5)
        assert robot == pytest.approx(speed - restitution * case.v, rel=1e-4, abs=1e-4)


def test_no_rotors_is_rigid_exactly(random):
    for eps in (0.0, 0.05, np.exp(-2), 0.5, 1.0):  # exp(-2) is critically damped: one mode twice
        case = random_case(random, restitution=eps)
        case.B = np.zeros(7)
        parted, speed, _ = collide(case)
        inertia = 1 / case.arm.mobility
        assert parted.time == pytest.approx(case.time, rel=1e-6)
        share = (1 + max(eps, 1e-4)) * inertia / (inertia + case.m)
        assert speed == pytest.approx(share * case.v, rel=1e-6)
        assert second_contact(parted) is None


def test_stiff_joints_show_the_rotors_too(random):
    for eps in (1.0, 0.6, 0.3):
        case = random_case(random, lightest=-1, restitution=eps)
        case.D = np.zeros(7)
        case.K = np.full(7, 1e4 * case.fastest**2)
        mobility = case.g @ np.linalg.solve(case.M + np.diag(case.B), case.g)
        _, speed, _ = collide(case)
        inertia = 1 / mobility
        per_mass = mobility + 1 / case.m  # the spring stays that of the rigid pair
        ratio = case.d * per_mass / (2 * np.sqrt(case.k * per_mass))
        share = (1 + restitution_of(ratio)) * inertia / (inertia + case.m)
        assert speed == pytest.approx(share * case.v, rel=2e-3)


def test_the_limit_of_stiff_joints_is_approached(random):
    case = random_case(random, lightest=-1, restitution=1.0)
    case.D = np.zeros(7)
    inertia = 1 / (case.g @ np.linalg.solve(case.M + np.diag(case.B), case.g))
    limit = 2 * inertia / (inertia + case.m) * case.v
    off = []
    for stiffness in (1e5, 1e7, 1e9):
        case.K = np.full(7, stiffness)
        off.append(abs(collide(case)[1] - limit))
    assert off[2] < off[1] < off[0]
    assert off[2] < 1e-3 * limit


def test_energy_does_not_grow():
    assert energy_grows(300, seed=3) == 0


def test_second_contacts_are_where_the_arm_pushes_again(random):
    found = 0
    for _ in range(40):
        case = random_case(random, stiffest=4, lightest=-3, restitution=0.1)
        case.m = 3.0
        case.time = 1e-3
        case.k, case.d = pair_spring(case.arm.mobility, case.m, 0.1, case.time)
        parted, _, _ = collide(case)
        again = second_contact(parted)
        if parted.time is None:
            assert again is None
            continue
        times = np.linspace(0, 0.1, 20001)
        rates = (np.exp(np.outer(times, parted.swing.rates)) @ parted.swing.rate(-1)).real
        depth = parted.depth + np.concatenate(
            [[0.0], np.cumsum((rates[1:] + rates[:-1]) / 2 * np.diff(times))]
        )
        apart = np.cumsum(depth < -1e-9) > 0
        pushed = (depth >= 0) & apart | (depth > 0) & (case.k * depth + case.d * rates > 1e-9)
        later = np.flatnonzero(pushed[1:]) + 1
        if len(later):
            found += 1
            assert again == pytest.approx(times[later[0]], abs=1e-5)
        else:
            assert again is None
    assert 3 < found < 40


def test_a_spring_of_the_pair_alone():
    assert pair_spring(0.5, 2.0, 0.7, 0.01) == contact_spring(0.7, 0.01)
