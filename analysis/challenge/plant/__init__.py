"""An independent plant: another engine and other laws than those that diagnosis fits.

MuJoCo moves the platform; the laws of cables, friction, frame, drive, cells and camera are the
plant's own. It imports nothing of this project but the ground floor. SI units and radians inside.
"""
