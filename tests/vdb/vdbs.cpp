// Writes OpenVDB files for tests: level sets, fog volumes, masks, vectors, and streams.
#include "vdb/vdbs.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <fstream>
#include <string>

using namespace openvdb;

namespace
{

FloatGrid::Ptr sphere()
{
    auto grid = tools::createLevelSetSphere<FloatGrid>(20, Vec3f(3, -5, 200000), 0.5f, 3);
    grid->setName("surface");
    return grid;
}

template <typename Grid> typename Grid::Ptr ball(typename Grid::ValueType inside)
{
    typename Grid::Ptr grid = Grid::create(typename Grid::ValueType(0));
    const Coord middle(10, 0, -10);
    CoordBBox box(middle.offsetBy(-20), middle.offsetBy(20));
    for (auto at = box.begin(); at; ++at)
        if (((*at) - middle).asVec3d().lengthSqr() <= 400)
            grid->tree().setValueOn(*at, inside);
    grid->setGridClass(GRID_FOG_VOLUME);
    grid->setName("density");
    grid->pruneGrid();
    return grid;
}

MaskGrid::Ptr mask()
{
    MaskGrid::Ptr grid = MaskGrid::create();
    grid->topologyUnion(*ball<FloatGrid>(1));
    grid->setName("density");
    return grid;
}

VectorGrid::Ptr vectors()
{
    VectorGrid::Ptr grid = VectorGrid::create();
    grid->tree().setValueOn(Coord(1, 2, 3), Vec3f(1, 2, 3));
    grid->setName("v");
    return grid;
}

GridBase::Ptr sheared()
{
    const Mat4d m(0.5, 0.1, 0.0, 0.0, 0.0, -0.25, 0.0, 0.0, 0.2, 0.0, 1.0, 0.0, 7.0, 8.0, 9.0,
                  1.0);
    FloatGrid::Ptr grid = tools::createLevelSetSphere<FloatGrid>(20, Vec3f(0), 1, 3);
    grid->setTransform(math::Transform::createLinearTransform(m));
    return grid;
}

GridBase::Ptr frustum()
{
    FloatGrid::Ptr grid = sphere();
    grid->setTransform(
        math::Transform::createFrustumTransform(BBoxd(Vec3d(0), Vec3d(100)), 0.5, 10, 1));
    return grid;
}

GridCPtrVec grids_of(const std::string &kind)
{
    if (kind == "sphere" || kind == "stream")
        return {sphere()};
    if (kind == "double")
        return {ball<DoubleGrid>(1)};
    if (kind == "int32")
        return {ball<Int32Grid>(-7)};
    if (kind == "bool")
        return {ball<BoolGrid>(true)};
    if (kind == "mask")
        return {mask()};
    if (kind == "vec3")
        return {vectors()};
    if (kind == "sheared")
        return {sheared()};
    if (kind == "frustum")
        return {frustum()};
    if (kind == "empty")
        return {FloatGrid::create()};
    if (kind == "half") {
        FloatGrid::Ptr grid = sphere();
        grid->setSaveFloatAsHalf(true);
        return {grid};
    }
    if (kind == "several") {
        FloatGrid::Ptr surface = sphere(), copy = FloatGrid::create(*surface);
        copy->setTree(surface->treePtr());
        copy->setName("copy");
        return {vectors(), ball<FloatGrid>(1), surface, copy};
    }
    return {};
}

} // namespace

int test_vdb_write(const char *kind, const char *path)
{
    initialize();
    const GridCPtrVec grids = grids_of(kind);
    if (grids.empty() && std::string(kind) != "none")
        return 0;
    if (std::string(kind) == "stream") {
        std::ofstream out(path, std::ios::binary);
        io::Stream(out).write(grids);
        return out.good();
    }
    io::File(path).write(grids);
    return 1;
}
