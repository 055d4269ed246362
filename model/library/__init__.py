"""What every left-out effect is made of, how they are found, chosen and built into the kernel.

The effects themselves are in `model.effects`, one file each.
"""
