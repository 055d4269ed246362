"""A second plant for the blind challenge, written from the design and the run folder's page alone.

Quaternions and Newton-Euler integrated by Runge-Kutta, lumped cables with vibration modes, LuGre
bristles, cells and a camera of its own. Whoever wrote its laws had read neither `model` nor the
first plant, and it imports nothing of this project but the ground floor. SI units and radians.
"""
