# The optional features of a build, a call each: library, licence, price, and a program that tries it.
include(core/add_feature.cmake)

# The libraries that no build is without.
quote_for_c(needed_licences "zlib (Zlib), Expat (MIT), libpng (libpng-2.0), Jansson (MIT), libmd (ISC)")

# C++ is for the wrappers of C++ libraries alone; without them no C++ compiler is needed.
if(CUBEWRIGHT_GLTF OR CUBEWRIGHT_DRACO OR CUBEWRIGHT_DICOM OR CUBEWRIGHT_OPENVDB OR CUBEWRIGHT_CGAL
   OR CUBEWRIGHT_OPENMESH OR CUBEWRIGHT_WINDOW)
  include(CheckLanguage)
  check_language(CXX)
  if(CMAKE_CXX_COMPILER)
    enable_language(CXX)
  endif()
endif()

if(CUBEWRIGHT_SECCOMP)
  find_path(SECCOMP_INCLUDE seccomp.h)
  find_library(SECCOMP_LIBRARY seccomp)
endif()
add_feature(seccomp OPTION CUBEWRIGHT_SECCOMP PACKAGES libseccomp-dev
  ABOUT "sandboxed processes for libraries that read files"
  COST "reads files with C++ libraries only with --no-sandbox"
  LICENCES "libseccomp (LGPL-2.1)"
  NEEDS SECCOMP_INCLUDE=libseccomp-dev SECCOMP_LIBRARY=libseccomp-dev
  INCLUDES ${SECCOMP_INCLUDE} LIBRARIES ${SECCOMP_LIBRARY}
  TRIAL [[
#include <seccomp.h>
int main(void)
{
    return seccomp_init(SCMP_ACT_ALLOW) == 0;
}
]])

if(CUBEWRIGHT_CGAL AND CMAKE_CXX_COMPILER)
  set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE ON CACHE INTERNAL "one file, with its own -O2")
  set(CMAKE_POLICY_DEFAULT_CMP0167 NEW) # its Boost describes itself; CMake 3.30 warns otherwise
  find_package(CGAL QUIET)
endif()
set(unsanitized ON)
if(CUBEWRIGHT_SANITIZE)
  set(unsanitized OFF) # sanitizers make its exact arithmetic crawl
endif()
add_feature(cgal OPTION CUBEWRIGHT_CGAL PACKAGES libcgal-dev
  SHIPPED cubewright-cgal MODULE cgal LANGUAGE CXX
  ABOUT "a second opinion on meshes, by CGAL (GPL)"
  COST "asks no second opinion on meshes"
  LICENCES "CGAL (GPL-3.0-or-later), GMP (LGPL-3.0-or-later)"
  NEEDS CGAL_FOUND=libcgal-dev "unsanitized=a build without sanitizers" LIBRARIES CGAL
  HEADERS CGAL/Polygon_mesh_processing/self_intersections.h CGAL/Surface_mesh.h
  TRIAL [[
#include <CGAL/Gmpq.h>
int main()
{
    return CGAL::Gmpq(1).numerator() != 1;
}
]])

add_feature(wrap OPTION CUBEWRIGHT_CGAL PACKAGES libcgal-dev
  SHIPPED cubewright-cgal MODULE wrap
  ABOUT "wraps in repair, by CGAL (GPL)"
  COST "wraps no meshes in repair"
  LICENCES "CGAL (GPL-3.0-or-later), GMP (LGPL-3.0-or-later), MPFR (LGPL-3.0-or-later)"
  LIKE cgal)

if(CUBEWRIGHT_OPENMESH AND CMAKE_CXX_COMPILER)
  find_package(OpenMesh QUIET CONFIG)
endif()
add_feature(simplify OPTION CUBEWRIGHT_OPENMESH PACKAGES libopenmesh-dev MODULE openmesh LANGUAGE CXX
  ABOUT "simplification of meshes, on OpenMesh"
  COST "does not simplify"
  LICENCES "OpenMesh (BSD-3-Clause)"
  NEEDS OpenMesh_FOUND=libopenmesh-dev LIBRARIES OpenMeshCore
  TRIAL [[
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
int main()
{
    OpenMesh::TriMesh_ArrayKernelT<> mesh;
    mesh.add_vertex(OpenMesh::Vec3f(0, 0, 0));
    return mesh.n_vertices() != 1;
}
]])

if(CUBEWRIGHT_OPENVDB AND CMAKE_CXX_COMPILER)
  find_path(OPENVDB_INCLUDE openvdb/openvdb.h)
  find_library(OPENVDB_LIBRARY openvdb)
  find_path(BOOST_INCLUDE boost/numeric/conversion/conversion_traits.hpp)
  find_package(TBB QUIET CONFIG)
  find_package(Imath QUIET CONFIG)
endif()
set(OPENVDB_LIBRARIES ${OPENVDB_LIBRARY} TBB::tbb Imath::Imath)
# TBB's containers, in headers, keep small numbers in pointers. For source files: a target's own
# options come before those that switch the sanitizers on.
if(CUBEWRIGHT_SANITIZE)
  set(OPENVDB_OPTIONS -fno-sanitize=undefined)
endif()
add_feature(vdb OPTION CUBEWRIGHT_OPENVDB PACKAGES libopenvdb-dev libboost-dev
  SHIPPED cubewright-modules MODULE openvdb LANGUAGE CXX
  ABOUT "sparse volumes, through OpenVDB"
  COST "reads no OpenVDB"
  LICENCES "OpenVDB (MPL-2.0), TBB (Apache-2.0), Imath (BSD-3-Clause)"
  NEEDS OPENVDB_INCLUDE=libopenvdb-dev OPENVDB_LIBRARY=libopenvdb-dev BOOST_INCLUDE=libboost-dev
        TBB_FOUND=libtbb-dev Imath_FOUND=libimath-dev
  HEADERS openvdb/openvdb.h openvdb/tools/MeshToVolume.h tbb/global_control.h
  INCLUDES ${OPENVDB_INCLUDE} ${BOOST_INCLUDE} LIBRARIES ${OPENVDB_LIBRARIES}
  TRIAL [[
#include <openvdb/MetaMap.h>
#include <openvdb/math/Math.h>
int main()
{
    openvdb::MetaMap map;
    return map.metaCount() != 0;
}
]])
add_feature(level-set OPTION CUBEWRIGHT_OPENVDB PACKAGES libopenvdb-dev libboost-dev
  SHIPPED cubewright-modules MODULE levelset
  ABOUT "offset and hollow, through OpenVDB"
  COST "does not offset and hollow meshes"
  LIKE vdb)

if(CUBEWRIGHT_GL OR CUBEWRIGHT_WINDOW)
  find_path(EPOXY_INCLUDE epoxy/egl.h)
  find_library(EPOXY_LIBRARY epoxy)
endif()
add_feature(gl OPTION CUBEWRIGHT_GL PACKAGES libepoxy-dev SHIPPED cubewright-modules MODULE gl
  ABOUT "volumes drawn by OpenGL"
  COST "draws volumes by the CPU alone"
  LICENCES "libepoxy (MIT)"
  NEEDS EPOXY_INCLUDE=libepoxy-dev EPOXY_LIBRARY=libepoxy-dev
  INCLUDES ${EPOXY_INCLUDE} LIBRARIES ${EPOXY_LIBRARY}
  TRIAL [[
#include <epoxy/egl.h>
#include <epoxy/gl.h>
int main(void)
{
    return epoxy_has_egl() && epoxy_gl_version();
}
]])

# Dear ImGui changes with every version: 1.86 to 1.91 have all that the window uses.
if(CUBEWRIGHT_WINDOW)
  find_path(IMGUI_INCLUDE imgui_internal.h PATH_SUFFIXES imgui)
  find_library(IMGUI_LIBRARY imgui)
  find_library(STB_LIBRARY stb)
  find_path(GLFW_INCLUDE GLFW/glfw3.h)
  find_library(GLFW_LIBRARY glfw)
  if(IMGUI_INCLUDE)
    file(STRINGS ${IMGUI_INCLUDE}/imgui.h imgui_version REGEX "define IMGUI_VERSION_NUM +(18[6-9]|19[01])")
  endif()
endif()
set(imgui_is_known OFF)
if(imgui_version)
  set(imgui_is_known ON)
endif()
add_feature(window OPTION CUBEWRIGHT_WINDOW SHIPPED cubewright-modules MODULE window LANGUAGE CXX
  PACKAGES libimgui-dev libglfw3-dev libstb-dev libepoxy-dev
  ABOUT "the window of view, by GLFW and Dear ImGui"
  COST "opens no window"
  LICENCES "GLFW (Zlib), Dear ImGui (MIT), stb (MIT), libepoxy (MIT), libpng (libpng-2.0)"
  NEEDS "imgui_is_known=libimgui-dev (1.86 to 1.91)" "IMGUI_LIBRARY=libimgui-dev (1.86 to 1.91)" STB_LIBRARY=libstb-dev
        GLFW_INCLUDE=libglfw3-dev GLFW_LIBRARY=libglfw3-dev EPOXY_INCLUDE=libepoxy-dev
        EPOXY_LIBRARY=libepoxy-dev
  INCLUDES ${IMGUI_INCLUDE} ${GLFW_INCLUDE} ${EPOXY_INCLUDE}
  LIBRARIES ${IMGUI_LIBRARY} ${STB_LIBRARY} ${GLFW_LIBRARY} ${EPOXY_LIBRARY}
  TRIAL [[
#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h>
int main()
{
    return glfwInit() && ImGui::CreateContext() && ImGui_ImplOpenGL3_Init(nullptr);
}
]])

if(CUBEWRIGHT_GLTF AND CMAKE_CXX_COMPILER)
  find_package(TinyGLTF QUIET CONFIG)
endif()
add_feature(gltf OPTION CUBEWRIGHT_GLTF PACKAGES libtinygltf-dev MODULE gltf LANGUAGE CXX
  ABOUT "glTF and GLB, through tinygltf"
  COST "reads and writes no glTF and no GLB"
  LICENCES "tinygltf (MIT)"
  NEEDS TinyGLTF_FOUND=libtinygltf-dev LIBRARIES TinyGLTF::TinyGLTF
  TRIAL [[
#include <tiny_gltf.h>
int main()
{
    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::string error, warning;
    return loader.LoadASCIIFromString(&model, &error, &warning, "{}", 2, "");
}
]])

if(CUBEWRIGHT_DRACO AND CMAKE_CXX_COMPILER)
  find_package(draco QUIET CONFIG)
endif()
add_feature(draco OPTION CUBEWRIGHT_DRACO PACKAGES libdraco-dev MODULE draco LANGUAGE CXX
  ABOUT "Draco compression in glTF"
  COST "has no Draco compression"
  LICENCES "Draco (Apache-2.0)"
  NEEDS draco_FOUND=libdraco-dev LIBRARIES draco::draco
  TRIAL [[
#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
int main()
{
    draco::Encoder encoder;
    draco::EncoderBuffer buffer;
    draco::Mesh mesh;
    return encoder.EncodeMeshToBuffer(mesh, &buffer).ok();
}
]])

if(CUBEWRIGHT_MESHOPT)
  find_package(meshoptimizer QUIET CONFIG)
endif()
add_feature(meshopt OPTION CUBEWRIGHT_MESHOPT PACKAGES libmeshoptimizer-dev MODULE meshopt
  ABOUT "meshopt compression in glTF"
  COST "has no meshopt compression"
  LICENCES "meshoptimizer (MIT)"
  NEEDS meshoptimizer_FOUND=libmeshoptimizer-dev LIBRARIES meshoptimizer::meshoptimizer
  TRIAL [[
#include <meshoptimizer.h>
int main(void)
{
    return meshopt_encodeVertexBufferBound(0, 16) == 0;
}
]])

if(CUBEWRIGHT_DICOM AND CMAKE_CXX_COMPILER)
  find_package(DCMTK QUIET CONFIG)
endif()
add_feature(dicom OPTION CUBEWRIGHT_DICOM PACKAGES libdcmtk-dev
  SHIPPED cubewright-modules MODULE dicom LANGUAGE CXX
  ABOUT "DICOM series, through DCMTK"
  COST "reads no DICOM"
  LICENCES "DCMTK (BSD-3-Clause)"
  NEEDS DCMTK_FOUND=libdcmtk-dev LIBRARIES DCMTK::dcmjpeg DCMTK::dcmjpls DCMTK::dcmdata
  TRIAL [[
#include <dcmtk/dcmdata/dcfilefo.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>
int main()
{
    DcmFileFormat file;
    DJDecoderRegistration::registerCodecs();
    DJLSDecoderRegistration::registerCodecs();
    return file.loadFile("none").good();
}
]])

if(CUBEWRIGHT_DICOM)
  find_path(OPENJPEG_INCLUDE openjpeg.h PATH_SUFFIXES openjpeg-2.5)
  find_library(OPENJPEG_LIBRARY openjp2)
endif()
add_feature(jpeg2000 OPTION CUBEWRIGHT_DICOM PACKAGES libopenjp2-7-dev
  SHIPPED cubewright-modules MODULE dicom
  ABOUT "DICOM compressed by JPEG 2000, through OpenJPEG"
  COST "reads no DICOM compressed by JPEG 2000"
  LICENCES "OpenJPEG (BSD-2-Clause)"
  NEEDS HAS_DICOM=libdcmtk-dev OPENJPEG_INCLUDE=libopenjp2-7-dev OPENJPEG_LIBRARY=libopenjp2-7-dev
  INCLUDES ${OPENJPEG_INCLUDE} LIBRARIES ${OPENJPEG_LIBRARY}
  TRIAL [[
#include <openjpeg.h>
int main(void)
{
    return opj_create_decompress(OPJ_CODEC_J2K) == NULL;
}
]])

if(CUBEWRIGHT_TIFF)
  find_package(TIFF 4.5 QUIET)
endif()
add_feature(tiff OPTION CUBEWRIGHT_TIFF PACKAGES libtiff-dev MODULE tiff
  ABOUT "TIFF stacks, through libtiff"
  COST "reads no TIFF"
  LICENCES "libtiff (libtiff)"
  NEEDS "TIFF_FOUND=libtiff-dev (4.5 or later)" LIBRARIES TIFF::TIFF
  TRIAL [[
#include <tiffio.h>
int main(void)
{
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    return TIFFOpenExt("none", "r", options) != NULL;
}
]])

add_feature(pictures OPTION CUBEWRIGHT_PICTURES PACKAGES libpng-dev MODULE picture
  ABOUT "PNG and BMP slices, through libpng"
  COST "reads no PNG or BMP"
  LICENCES "libpng (libpng-2.0)"
  NEEDS "PNG_FOUND=libpng-dev" LIBRARIES PNG::PNG
  TRIAL [[
#include <png.h>
int main(void)
{
    return png_create_read_struct(PNG_LIBPNG_VER_STRING, 0, 0, 0) == 0;
}
]])

# Debian has a serial library and others for MPI, in folders beside each other: the serial one is taken.
if(CUBEWRIGHT_HDF5)
  find_path(HDF5_INCLUDE hdf5.h PATH_SUFFIXES hdf5/serial)
  find_library(HDF5_LIBRARY NAMES hdf5_serial hdf5)
endif()
add_feature(hdf5 OPTION CUBEWRIGHT_HDF5 PACKAGES libhdf5-dev SHIPPED cubewright-modules MODULE hdf5
  ABOUT "VTKHDF volumes and surfaces, through HDF5"
  COST "reads no VTKHDF"
  LICENCES "HDF5 (BSD-3-Clause)"
  NEEDS HDF5_INCLUDE=libhdf5-dev HDF5_LIBRARY=libhdf5-dev
  INCLUDES ${HDF5_INCLUDE} LIBRARIES ${HDF5_LIBRARY}
  TRIAL [[
#include <hdf5.h>
int main(void)
{
    return H5open() < 0;
}
]])

if(CUBEWRIGHT_ISAL)
  find_path(ISAL_INCLUDE isa-l/igzip_lib.h)
  find_library(ISAL_LIBRARY isal)
endif()
add_feature(isal OPTION CUBEWRIGHT_ISAL PACKAGES libisal-dev
  ABOUT "compressed volumes read in half the time, by ISA-L"
  COST "reads compressed volumes by zlib, at half the speed"
  LICENCES "ISA-L (BSD-3-Clause)"
  NEEDS ISAL_INCLUDE=libisal-dev ISAL_LIBRARY=libisal-dev
  INCLUDES ${ISAL_INCLUDE} LIBRARIES ${ISAL_LIBRARY}
  TRIAL [[
#include <isa-l/igzip_lib.h>
int main(void)
{
    struct inflate_state state;
    isal_inflate_init(&state);
    return isal_inflate(&state) == 0;
}
]])

if(CUBEWRIGHT_LZ4)
  find_path(LZ4_INCLUDE lz4.h)
  find_library(LZ4_LIBRARY lz4)
endif()
add_feature(lz4 OPTION CUBEWRIGHT_LZ4 PACKAGES liblz4-dev
  ABOUT "VTK image data, Zarr and N5 compressed with LZ4"
  COST "reads no .vti that is compressed with LZ4, nor such Zarr and N5"
  LICENCES "LZ4 (BSD-2-Clause)"
  NEEDS LZ4_INCLUDE=liblz4-dev LZ4_LIBRARY=liblz4-dev
  INCLUDES ${LZ4_INCLUDE} LIBRARIES ${LZ4_LIBRARY}
  TRIAL [[
#include <lz4.h>
int main(void)
{
    return LZ4_versionNumber() == 0;
}
]])

if(CUBEWRIGHT_BZIP2)
  find_path(BZIP2_INCLUDE bzlib.h)
  find_library(BZIP2_LIBRARY bz2)
endif()
add_feature(bzip2 OPTION CUBEWRIGHT_BZIP2 PACKAGES libbz2-dev
  ABOUT "NRRD, Zarr and N5 volumes compressed with bzip2"
  COST "reads no NRRD, Zarr or N5 that is compressed with bzip2"
  LICENCES "bzip2 (bzip2-1.0.6)"
  NEEDS BZIP2_INCLUDE=libbz2-dev BZIP2_LIBRARY=libbz2-dev
  INCLUDES ${BZIP2_INCLUDE} LIBRARIES ${BZIP2_LIBRARY}
  TRIAL [[
#include <bzlib.h>
int main(void)
{
    return *BZ2_bzlibVersion() == 0;
}
]])

if(CUBEWRIGHT_ZSTD)
  find_path(ZSTD_INCLUDE zstd.h)
  find_library(ZSTD_LIBRARY zstd)
endif()
add_feature(zstd OPTION CUBEWRIGHT_ZSTD PACKAGES libzstd-dev
  ABOUT "Zarr and N5 volumes compressed with Zstandard"
  COST "reads no Zarr or N5 that is compressed with Zstandard"
  LICENCES "Zstandard (BSD-3-Clause)"
  NEEDS ZSTD_INCLUDE=libzstd-dev ZSTD_LIBRARY=libzstd-dev
  INCLUDES ${ZSTD_INCLUDE} LIBRARIES ${ZSTD_LIBRARY}
  TRIAL [[
#include <zstd.h>
#include <zstd_errors.h>
int main(void)
{
    return ZSTD_getErrorCode(0) != ZSTD_error_no_error;
}
]])

if(CUBEWRIGHT_BLOSC)
  find_path(BLOSC_INCLUDE blosc.h)
  find_library(BLOSC_LIBRARY blosc)
endif()
add_feature(blosc OPTION CUBEWRIGHT_BLOSC PACKAGES libblosc-dev MODULE blosc
  ABOUT "Zarr and N5 volumes compressed with Blosc"
  COST "reads no Zarr or N5 that is compressed with Blosc"
  LICENCES "Blosc (BSD-3-Clause)"
  NEEDS BLOSC_INCLUDE=libblosc-dev BLOSC_LIBRARY=libblosc-dev
  INCLUDES ${BLOSC_INCLUDE} LIBRARIES ${BLOSC_LIBRARY}
  TRIAL [[
#include <blosc.h>
int main(void)
{
    size_t bytes;
    return blosc_cbuffer_validate("", 0, &bytes) == 0;
}
]])

# What a compiler wrapper of an MPI adds: sets ${name}_INCLUDE and ${name}_LIBRARY.
function(find_mpi name wrapper library)
  find_program(${name}_WRAPPER ${wrapper})
  if(NOT ${name}_WRAPPER)
    return()
  endif()
  execute_process(COMMAND ${${name}_WRAPPER} -show OUTPUT_VARIABLE line ERROR_QUIET)
  string(REGEX MATCHALL " -I[^ \n]+" includes "${line}")
  string(REGEX MATCHALL " -L[^ \n]+" folders "${line}")
  list(TRANSFORM includes REPLACE "^ -I" "")
  list(TRANSFORM folders REPLACE "^ -L" "")
  find_path(${name}_INCLUDE mpi.h HINTS ${includes} NO_DEFAULT_PATH)
  find_library(${name}_LIBRARY ${library} HINTS ${folders} NO_DEFAULT_PATH)
endfunction()

set(mpi_trial [[
#include <mpi.h>
#include <stddef.h>
int main(void)
{
    int level;
    return MPI_Init_thread(NULL, NULL, MPI_THREAD_MULTIPLE, &level);
}
]])
if(CUBEWRIGHT_MPI)
  find_mpi(OPENMPI mpicc.openmpi mpi)
  find_mpi(MPICH mpicc.mpich mpich)
endif()
add_feature(openmpi OPTION CUBEWRIGHT_MPI PACKAGES libopenmpi-dev
  SHIPPED cubewright-mpi MODULE openmpi
  ABOUT "extraction by the ranks of Open MPI"
  COST "is no rank of Open MPI"
  LICENCES "Open MPI (BSD-3-Clause)"
  NEEDS OPENMPI_INCLUDE=libopenmpi-dev OPENMPI_LIBRARY=libopenmpi-dev
  INCLUDES ${OPENMPI_INCLUDE} LIBRARIES ${OPENMPI_LIBRARY} TRIAL "${mpi_trial}")
add_feature(mpich OPTION CUBEWRIGHT_MPI PACKAGES libmpich-dev SHIPPED cubewright-mpi MODULE mpich
  ABOUT "extraction by the ranks of MPICH"
  COST "is no rank of MPICH"
  LICENCES "MPICH (mpich2)"
  NEEDS MPICH_INCLUDE=libmpich-dev MPICH_LIBRARY=libmpich-dev
  INCLUDES ${MPICH_INCLUDE} LIBRARIES ${MPICH_LIBRARY} TRIAL "${mpi_trial}")

configure_file(core/features_table.c.in features_table.c @ONLY)
