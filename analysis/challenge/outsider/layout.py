"""Where each number stands in the arrays that the compiled laws read and write."""

# Numbers of a cable, one row each; a law whose number is zero is left out.
STIFFNESS = 0  # N/m
PRETENSION = 1  # N, at rest
DENSITY = 2  # kg/m
STRING_LOSS = 3  # 1/s, of the first transverse mode
BASE = 4  # three coordinates in O-XYZ, m
ANCHOR = 7  # three coordinates from the true centre of mass, platform frame, m
REST_LENGTH = 10  # m
MODES = 11  # transverse modes in each plane, 1 to 3
PLANES = 12  # 1: the vertical plane; 2: the horizontal one too
SHAKEN = 13  # 1: the moving anchor shakes the string, and the string the platform
BRISTLE = 14  # N/m, stiffness of the bristles
BRISTLE_LOSS = 15  # N s/m
COULOMB = 16  # N
STATIC = 17  # N
STRIBECK = 18  # m/s
CAPSTAN = 19  # friction times angle of wrap
VISCOUS = 20  # N s/m
MAXWELL = 21  # stiffness of five branches, N/m
MAXWELL_TIME = 26  # their relaxation times, s
LOOP = 31  # Bouc-Wen's share of the stiffness
LOOP_YIELD = 32  # m
LOOP_POWER = 33
PLAY = 34  # half the clearance, m
STIFFENING = 35  # relative growth of the stiffness for a doubled tension
CREEP = 36  # m for each factor e of time
UNILATERAL = 37  # 1: the cable cannot push
WEIGHT = 38  # N/m, transverse weight; 0: no sag
FRONT = 39  # N/m, of the part before a pulley with inertia; 0: no such pulley
BACK = 40  # N/m, of the part behind it
RIM_MASS = 41  # kg
FRICTION_AT_REST = 42  # N, what the bristles hold at rest and the pretension already contains
SLIDING = 43  # Iwan's share of the stiffness
SLIDING_YIELD = 44  # m
POST = 45  # of the frame, 0 to 3
CABLE_NUMBERS = 46

BRANCHES = 5
MOST_MODES = 3

# States of a cable, from CABLES + i * CABLE_STATES.
STRING = 0  # amplitude (m) and rate of each mode of the first plane, then of the second
BENT = 12  # deflection of the bristles, m
BRANCH = 13  # stretch of the spring of each Maxwell branch, m
LOOPED = 18  # Bouc-Wen's z, m
SLID = 19  # stretch of each Iwan slider, m
RIM = 24  # way of the pulley's rim, m, and its speed
CABLE_STATES = 26

# The whole state.
PLACE = 0  # centre of mass in O-XYZ, m
ATTITUDE = 3  # unit quaternion, scalar first
SPEED = 7  # m/s
SPIN = 10  # angular velocity in O-XYZ, rad/s
FRAME = 13  # four posts: three displacements (m) and three rates
CABLES = 37
STATES = CABLES + 8 * CABLE_STATES

# Numbers of platform and frame.
MASS = 0  # kg
DAMPING = 1  # N s/m
TURNING_DAMPING = 2  # N m s
DRAG = 3  # N s2/m2, rho C_d A / 2
DRAG_ARM = 4  # m, where the drag acts
HOSE = 5  # N/m
HOSE_LOSS = 6  # N s/m
HOSE_AT = 7  # three coordinates from the true centre of mass, platform frame, m
HOSE_FROM = 10  # three coordinates in O-XYZ, where it hangs relaxed, m
POST_STIFFNESS = 13  # N/m; 0: a rigid frame
POST_MASS = 14  # kg
POST_LOSS = 15  # N s/m
TRACKED = 16  # three coordinates of the rig file's centre of mass from the true one, m
PLATFORM_NUMBERS = 19
