# vbond in Spack. Not published and not tried: in a repository of one's own as packages/vbond/package.py, with the
# source release beside it. Where Spack has no tomlplusplus, that repository needs it, too, built as a shared library.
import os

from spack.package import *


class Vbond(CMakePackage):
    """Simulates deformation, buckling and vibration of solids that can be made of rigid particles and elastic bonds."""

    url = "file://" + os.path.join(os.path.dirname(__file__), "vbond-0.1.0.tar.xz")
    license("BSD-3-Clause")

    # sha256sum vbond-0.1.0.tar.xz; without it: spack install --no-checksum vbond
    version("0.1.0")

    variant("statics", default=True, description="Equilibria, paths, critical loads, modes (links CHOLMOD and UMFPACK, GPL)")
    variant("multigrid", default=False, when="+statics", description="The program vbond-petsc instead of vbond")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("cli11@2.1:", type="build")
    depends_on("libmicrohttpd")
    depends_on("fmt@9:")
    depends_on("tomlplusplus@3.3:")
    depends_on("nlohmann-json@3.11:")
    depends_on("hdf5@1.10:", when="~multigrid")
    depends_on("hdf5@1.10: +mpi", when="+multigrid")
    depends_on("zlib-api")
    depends_on("assimp@5.2:")
    depends_on("voropp@0.4.6")
    with when("+statics"):
        depends_on("suite-sparse@5.12:")
        depends_on("openblas")
        depends_on("eigen@3.4:")
        depends_on("spectra@1:")
        depends_on("ceres-solver@2.1:")
    with when("+multigrid"):
        depends_on("petsc@3.18: +mpi")
        depends_on("mpi")
        depends_on("pkgconfig", type="build")

    conflicts("%gcc@:11")

    def cmake_args(self):
        return [
            self.define("VBOND_TESTS", False),
            self.define_from_variant("VBOND_STATICS", "statics"),
            self.define_from_variant("VBOND_PETSC", "multigrid"),
        ]
