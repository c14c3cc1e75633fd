"""What the files of two runs hold, compared bit by bit."""
import netCDF4
import numpy

FILES = ("fields.nc", "parcels.nc", "profiles.nc", "series.nc")


def variables(dataset, prefix=""):
    """{path: variable} of a netCDF group and all groups in it."""
    found = {prefix + name: variable for name, variable in dataset.variables.items()}
    for name, group in dataset.groups.items():
        found |= variables(group, f"{prefix}{name}/")
    return found


def attributes(variable):
    return {name: str(variable.getncattr(name)) for name in variable.ncattrs()}


def first_difference(a, b):
    """In which record (first index) two arrays of one shape begin to differ."""
    for record in range(len(a) if a.ndim else 0):
        if a[record].tobytes() != b[record].tobytes():
            return f"record {record}"
    return "the value"


def differences_of_files(path_a, path_b):
    """One sentence per difference in names, attributes, shapes and values; empty when equal."""
    found = []
    with netCDF4.Dataset(path_a) as a, netCDF4.Dataset(path_b) as b:
        for dataset in (a, b):
            dataset.set_auto_maskandscale(False)
        left, right = variables(a), variables(b)
        if list(left) != list(right):
            return [f"variables {sorted(set(left) ^ set(right))} are in one file only"]
        for name in left:
            if attributes(left[name]) != attributes(right[name]):
                found.append(f"{name}: attributes differ")
            x, y = numpy.asarray(left[name][...]), numpy.asarray(right[name][...])
            if x.shape != y.shape:
                found.append(f"{name}: shape {x.shape} and {y.shape}")
            elif x.tobytes() != y.tobytes():
                found.append(f"{name}: {first_difference(x, y)} differs")
    return [f"{path_a.name}: {sentence}" for sentence in found]


def differences(folder_a, folder_b, files=FILES):
    """All differences between the output files of two runs."""
    return [line for file in files
            for line in differences_of_files(folder_a / file, folder_b / file)]


def read(path, name):
    """One variable of a file, as an array."""
    with netCDF4.Dataset(path) as dataset:
        dataset.set_auto_maskandscale(False)
        return variables(dataset)[name][...]


def parcel_records(path):
    """The identities of the parcels in each record of parcels.nc."""
    with netCDF4.Dataset(path) as dataset:
        dataset.set_auto_maskandscale(False)
        found = {name.split("/")[-1]: v[...] for name, v in variables(dataset).items()}
    ends = found["row_size"].cumsum()
    return [set(found["uid"][end - size:end].tolist())
            for end, size in zip(ends.tolist(), found["row_size"].tolist())]
