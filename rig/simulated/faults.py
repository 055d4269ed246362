"""What a bad line does to bytes: seeded, and told to no one but a test."""

from dataclasses import dataclass, field

import numpy as np

KINDS = ("flip", "drop", "insert", "twist")


@dataclass
class LineFaults:
    """Faults per byte, in both directions.

    Attributes
    ----------
    generator
        Draws them.
    flip
        Probability that one bit of a byte is turned; a parity bit betrays it.
    drop
        Probability that a byte is lost.
    insert
        Probability that a random byte comes before one.
    twist
        Probability that two bits of a byte are turned, which no parity bit betrays.
    count
        How many faults have been done, by kind.
    """

    generator: np.random.Generator
    flip: float = 0.0
    drop: float = 0.0
    insert: float = 0.0
    twist: float = 0.0
    count: dict[str, int] = field(default_factory=lambda: dict.fromkeys(KINDS, 0))

    def spoil(self, data: bytes, has_parity: bool) -> tuple[bytes, bool]:
        """The bytes as they arrive, and whether the receiver sees a parity error in them."""
        draws = self.generator.random(len(data))
        if not (draws < self.flip + self.drop + self.insert + self.twist).any():
            return data, False
        spoiled = bytearray()
        damaged = False
        for byte, draw in zip(data, draws, strict=True):
            if draw < self.flip:
                spoiled.append(byte ^ (1 << int(self.generator.integers(8))))
                self.count["flip"] += 1
                damaged |= has_parity
            elif draw < self.flip + self.drop:
                self.count["drop"] += 1
            elif draw < self.flip + self.drop + self.insert:
                spoiled += bytes([int(self.generator.integers(256)), byte])
                self.count["insert"] += 1
            elif draw < self.flip + self.drop + self.insert + self.twist:
                one, other = self.generator.choice(8, 2, replace=False)
                spoiled.append(byte ^ (1 << int(one)) ^ (1 << int(other)))
                self.count["twist"] += 1
            else:
                spoiled.append(byte)
        return bytes(spoiled), damaged
