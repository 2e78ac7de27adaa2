"""Makes matlab-v7.mat and matlab-v6.mat with SciPy, matlab-v7.3.mat with hdf5storage, groups.h5 and packed.h5 with h5py and
netcdf-4.nc with netCDF4: writers that are not ours.

    pip install numpy scipy==1.17.1 h5py==3.16.0 hdf5storage==0.2.2 netCDF4==1.7.5.1 && python make.py

Times, a vector, a matrix of two channels, whole numbers, a speed, and what is to be passed over.
"""
import os

import h5py
import hdf5storage
import netCDF4
import numpy as np
from scipy.io import savemat

n = 200
t = np.arange(n) / 1000
variables = {
    "t_s": t.reshape(-1, 1),
    "acc_m_s2": np.sin(2 * np.pi * 50 * t).reshape(1, -1),
    "raw": np.column_stack([np.arange(n), -np.arange(n)]).astype(np.int16),
    "X097RPM": np.array([[1796]], dtype=np.uint16),
    "fs": 1000.0,
    "note": "text",
    "cell": np.array([1, "a"], dtype=object),
    "phasor": np.exp(1j * t),
}
for name, compressed in [("matlab-v7.mat", True), ("matlab-v6.mat", False)]:
    savemat(name, variables, do_compression=compressed, oned_as="column")
    # The date in the heading would change from run to run.
    with open(name, "r+b") as file:
        file.write(b"MATLAB 5.0 MAT-file, SciPy".ljust(116))

hdf5 = "matlab-v7.3.mat"
if os.path.exists(hdf5):
    os.remove(hdf5)
hdf5storage.writes(variables, filename=hdf5, matlab_compatible=True, store_python_metadata=False)
with open(hdf5, "r+b") as file:
    file.write(b"MATLAB 7.3 MAT-file, hdf5storage".ljust(116))

with h5py.File("groups.h5", "w", libver="latest") as file:
    first = file.create_group("run1", track_order=True)
    first.attrs["sampling_rate"] = np.float32(1000.0)
    first.create_dataset("time", data=t.astype("f4"))
    chunked = {"chunks": (64,), "compression": "gzip", "shuffle": True, "fletcher32": True}
    first.create_dataset("acc", data=variables["acc_m_s2"][0], **chunked).attrs["units"] = "m/s^2"
    first.create_dataset("raw", data=variables["raw"].astype(">i4"), chunks=(50, 1))
    first["speed_rpm"] = np.uint16(1796)
    first["flag"] = True
    first["note"] = "text"
    first["phasor"] = np.exp(1j * t)
    second = file.create_group("run2")
    second["p [bar]"] = np.arange(80.0).astype("f2").astype("f4")
    second["p [bar]"].attrs["fs"] = 500
    second["again"] = first  # A hard link, and one that leads nowhere.
    second["gone"] = h5py.SoftLink("/nowhere")
    file["other"] = h5py.ExternalLink("groups.h5", "/run1")

with h5py.File("packed.h5", "w", libver="latest") as file:
    # As NetCDF packs values, with samples that are missing.
    file["fs"] = 1000.0
    packed = np.arange(100, dtype="i2")
    packed[[7, 50]] = -32768, -1
    for name, attributes in [
        ("acc", {"scale_factor": np.float32(0.5), "add_offset": 10.0, "_FillValue": np.int16(-32768), "missing_value": np.int16(-1)}),
        ("odd", {"scale_factor": [1.0, 2.0]}),
    ]:
        file[name] = packed
        file[name].attrs.update(attributes)

with netCDF4.Dataset("netcdf-4.nc", "w") as file:
    file.createDimension("time", None)
    file.createDimension("nothing", 200)
    file.createVariable("time", "f8", ("time",)).units = "seconds since 2026-01-01 00:00:00"
    file.createVariable("pressure", "f4", ("time",), zlib=True).units = "kPa"
    file["time"][:] = t
    file["pressure"][:] = np.arange(n)
