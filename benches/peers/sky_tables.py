"""Writes the tables of the Hosek-Wilkie sky as Gonio embeds them.

    python sky_tables.py MITSUBA_DATA/sunsky/sunsky_datasets.bin crates/gonio-env/src/sky/hosek_wilkie.bin

The source is the container that Mitsuba 3 ships (`tensor_file` 1.0, BSD-3); single precision, one array after the other:

    sky parameters, spectral   [turbidity 10][albedo 2][control point 6][wavelength 11][9]
    sky mean radiance, spectral              [10][2][6][11]
    sky parameters, RGB                      [10][2][6][3][9]
    sky mean radiance, RGB                   [10][2][6][3]
    sun radiance, spectral     [turbidity 10][elevation segment 45][wavelength 11][power 4]
    limb darkening             [wavelength 11][power 6]

The container's RGB sun is left out: with its published factor it is 7 % brighter than the spectral one, which Gonio integrates.
"""
import struct
import sys

import numpy as np

def read(path):
    data = open(path, "rb").read()
    assert data[:12] == b"tensor_file\0" and data[12:14] == b"\1\0"
    (count,) = struct.unpack_from("<I", data, 14)
    at, fields = 18, {}
    for _ in range(count):
        (length,) = struct.unpack_from("<H", data, at)
        name = data[at + 2 : at + 2 + length].decode()
        at += 2 + length
        rank, kind, offset = struct.unpack_from("<HBQ", data, at)
        assert kind == 11, "double precision"
        shape = struct.unpack_from(f"<{rank}Q", data, at + 11)
        at += 11 + 8 * rank
        fields[name] = np.frombuffer(data, "<f8", int(np.prod(shape)), offset).reshape(shape)
    return fields


def main():
    source, target = sys.argv[1:]
    f = read(source)
    parts = [
        f["sky_params_spec"], f["sky_rad_spec"], f["sky_params_rgb"], f["sky_rad_rgb"],
        f["sun_rad_spec"], f["sun_ld_spec"],
    ]
    with open(target, "wb") as out:
        for part in parts:
            out.write(part.astype("<f4").tobytes())


main()
