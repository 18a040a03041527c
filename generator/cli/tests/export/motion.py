import ctypes
import sys
from ctypes import byref, c_double, c_int32, c_void_p


class Surface(ctypes.Structure):
    _fields_ = [("mu", c_double), ("e", c_double), ("law", c_int32)]


class Event(ctypes.Structure):
    _fields_ = [("time", c_double), ("energy_change", c_double), ("impulse", 3 * c_double), ("kind", c_int32), ("contact", c_int32)]


library = ctypes.CDLL(sys.argv[1])
library.planar_double_pendulum_simulation_free.restype = None
parameters, q, u, mechanism = (5 * c_double)(), (2 * c_double)(), (2 * c_double)(), (64 * c_double)()
motion, event, surface = c_void_p(), Event(), Surface(0.3, 0.5, 2)  # 2: Stronge's hypothesis
library.planar_double_pendulum_default_parameters(parameters)
library.planar_double_pendulum_default_coordinates(q)
library.planar_double_pendulum_default_speeds(u)
assert library.planar_double_pendulum_new(parameters, mechanism) == 0
started = library.planar_double_pendulum_simulation_new(mechanism, c_double(0), q, u, c_double(1e-12), byref(surface), byref(motion))
assert started == 0
while library.planar_double_pendulum_simulation_advance(motion, c_double(2), byref(event)) == 1:  # at an event
    pass
library.planar_double_pendulum_simulation_state(motion, q, u)
library.planar_double_pendulum_simulation_free(motion)
print(*q, *u)
