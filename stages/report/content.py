# SPDX-License-Identifier: GPL-3.0-or-later
"""The hash that records name their inputs by: XXH3, 128 bits, as 32 hexadecimal digits. Needs libxxhash."""

import ctypes
import ctypes.util

PIECE = 1 << 22  # bytes read at once


class Hash128(ctypes.Structure):
    _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]


def library():
    """libxxhash with the calls that are needed, or None."""
    name = ctypes.util.find_library("xxhash") or "libxxhash.so.0"
    try:
        found = ctypes.CDLL(name)
        found.XXH3_createState.restype = ctypes.c_void_p
        found.XXH3_freeState.argtypes = [ctypes.c_void_p]
        found.XXH3_128bits_reset.argtypes = [ctypes.c_void_p]
        found.XXH3_128bits_update.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_size_t]
        found.XXH3_128bits_digest.argtypes = [ctypes.c_void_p]
        found.XXH3_128bits_digest.restype = Hash128
    except (OSError, AttributeError):
        return None
    return found


XXHASH = library()


def file_hash(file):
    """Only where XXHASH is there."""
    state = XXHASH.XXH3_createState()
    try:
        XXHASH.XXH3_128bits_reset(state)
        with file.open("rb") as content:
            while piece := content.read(PIECE):
                XXHASH.XXH3_128bits_update(state, piece, len(piece))
        found = XXHASH.XXH3_128bits_digest(state)
    finally:
        XXHASH.XXH3_freeState(state)
    return f"{found.high:016x}{found.low:016x}"
