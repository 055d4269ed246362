"""Where each number stands in the arrays that the compiled laws read and write."""

# Parameters of a cable, one row each.
BASE = 0  # three coordinates in O-XYZ, m
ANCHOR = 3  # three coordinates from the centre of mass, platform frame, m
REST_PATH = 6  # length of the path at rest, m
STIFFNESS = 7  # N/m
PRETENSION = 8  # N
DENSITY = 9  # kg/m
STRING_LOSS = 10  # 1/s, of the transverse vibration
REST_DIRECTION = 11  # three components, from anchor to base
BEHIND = 14  # 1 where the cell does not see the friction of the pulley
SLACK = 15  # m too long
CUBIC = 16  # N/m3
CUBIC_REACH = 17  # m, where stiffening gives way to saturation
SAG = 18  # share of the weight, 0: a straight line
VISCOUS = 19  # N s/m
VISCOUS_TIME = 20  # s, of the spring in series with the dashpot
RELAX = 21  # two shares of the stiffness
RELAX_TIME = 23  # two times, s
LOSS_FACTOR = 25
LOOP = 26  # share of the stiffness
LOOP_YIELD = 27  # m, the middle of the sliders' yields
CREEP = 28  # share of the elastic elongation, for each factor e of time
CREEP_TIME = 29  # s
MODES = 30  # coupling of further modes
SHAKEN = 31  # share of the anchor's movement that shakes the first mode
PLAY = 32  # m, half the way of the hook
HOLD = 33  # N
RADIUS = 34  # m, of the pulley
RIM = 35  # kg at the rim
COULOMB = 36  # N
STATIC = 37  # N
STRIBECK = 38  # m/s
BRISTLE = 39  # m, length of a bristle
CAPSTAN = 40  # friction times angle of wrap
CAPSTAN_BRISTLE = 41  # m
CABLE_NUMBERS = 42

# States of a cable.
OLD = 0  # elongation one step before, m
STRING = 1  # mid-span amplitude, m, and its rate
BENT = 3  # bristle, m
BENT_CAPSTAN = 4  # share of full slip
MAXWELL = 5  # forces of two relaxation branches, N
DASHPOT = 7  # force of the viscous branch, N
LADDER = 8  # forces of the structural ladder, N
RUNGS = 8
SLIDER = 16  # stretch of the hysteresis sliders, m
SLIDERS = 8
CREPT = 24  # m
HOOK = 25  # m
WHEEL = 26  # way of the rim, m, and its speed
MODE = 28  # amplitude of each further mode, then the rates
OVERTONES = 7
OLD_SWAY = 42  # speed of the anchor across the cable one step before, m/s
STARTED = 43  # 1 once the old values are there
CABLE_STATES = 44

# Numbers of platform and frame.
MASS = 0
GRAVITY = 1
DRAG_LINEAR = 2  # N s/m
DRAG_TURNING = 3  # N m s
FACES = 4  # rho C_d A / 2 of the faces across X, Y, Z, kg/m
TURNING_AIR = 7  # N m s2
HOSE = 8  # N/m
HOSE_TURNING = 9  # N m/rad
HOSE_LOSS = 10  # s
HOSE_HARDENING = 11  # 1/m2
FRAME_GIVE = 12  # m/N
FRAME_HZ = 13
FRAME_LOSS = 14
PLATFORM_NUMBERS = 15

POSTS = 4
