"""Plan a hit with joint 6 of the iiwa 14, roll it out, and print what happens at the impact."""

import hitjoints as hj

robot = hj.load_robot("iiwa14")
hit = hj.Hit(6, [0.5, 0.3, 0.5], [0, 1, 0], mass=2.0, flux=0.3)
result = hj.rollout(robot, hit)
impact = result.impact
assert impact is not None, result.reason

print(f"impact after {impact.time:.3f} s, {1e3 * impact.miss:.2f} mm off")
print(f"inertia {impact.inertia:.2f} kg, speed {impact.speed:.3f} m/s, flux {impact.flux:.3f} m/s")
after = hj.object_speed(impact.inertia, hit.mass, impact.speed, restitution=0.5)
print(f"the object leaves at {after:.3f} m/s")
print(f"fastest joint at {100 * result.velocity_ratio_max:.0f} % of its limit")
print(result.dataset)
