// Times cw_extract() of sparse grids beside OpenVDB's volumeToMesh: runs of ours and theirs
// alternate; medians.
//
// bench_sparse [--threads 2] [--runs 9] [FILE.vdb ISOVALUE]...
//
// Level sets of spheres, of which the largest fills 645^3 voxels, 1 GB of floats, and one with
// holes throughout; then the files. Prints a JSON line a case on stdout, a table on stderr.
// volumeToMesh makes no normals, so ours are timed without (plain) and with them.
#include <cubewright/cubewright.h>

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <unistd.h>
#include <vector>

using namespace openvdb;

namespace
{

struct settings {
    int threads = 2, runs = 9;
};

double now_ms()
{
    using namespace std::chrono;
    return duration<double, std::milli>(steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> times)
{
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

double ours_ms(const cw_volume &v, double isovalue, bool normals, int threads,
               size_t *triangles)
{
    cw_mesh mesh = {};
    cw_error err;
    cw_extract_desc desc = {};
    desc.isovalue = isovalue;
    desc.inside_is_low = v.known & CW_KNOWN_LEVEL_SET;
    desc.no_normals = !normals;
    desc.threads = threads;
    const double start = now_ms();
    if (cw_extract(&v, &desc, &mesh, nullptr, &err) != CW_OK) {
        std::fprintf(stderr, "%s\n", err.message);
        std::exit(1);
    }
    const double time = now_ms() - start;
    *triangles = mesh.triangle_count;
    cw_mesh_free(&mesh);
    return time;
}

double theirs_ms(const FloatGrid &grid, double isovalue, size_t *quads)
{
    std::vector<Vec3s> points;
    std::vector<Vec4I> quadrangles;
    const double start = now_ms();
    tools::volumeToMesh(grid, points, quadrangles, isovalue);
    const double time = now_ms() - start;
    *quads = quadrangles.size();
    return time;
}

void measure(const std::string &name, const FloatGrid &grid, const cw_volume &v,
             double isovalue, const settings &s)
{
    std::vector<double> plain, shaded, theirs;
    size_t triangles = 0, quads = 0;
    for (int run = 0; run <= s.runs; run++) { // the first is not counted
        const double times[] = {ours_ms(v, isovalue, false, s.threads, &triangles),
                                theirs_ms(grid, isovalue, &quads),
                                ours_ms(v, isovalue, true, s.threads, &triangles)};
        if (run == 0)
            continue;
        plain.push_back(times[0]);
        theirs.push_back(times[1]);
        shaded.push_back(times[2]);
    }
    const double a = median(plain), b = median(shaded), c = median(theirs);
    const double millions = double(grid.activeVoxelCount()) / 1e6;
    std::fprintf(stderr, "%-16s %9.3f %9.1f %9.1f %9.1f %7.2f %7.2f %10zu %10zu\n",
                 name.c_str(), millions, a, b, c, c / a, c / b, triangles, 2 * quads);
    std::printf(
        "{\"case\": \"%s\", \"threads\": %d, \"active_millions\": %.3f, \"plain_ms\": %.2f, "
        "\"normals_ms\": %.2f, \"vdb_ms\": %.2f, \"plain_ratio\": %.3f, "
        "\"normals_ratio\": %.3f, \"triangles\": %zu, \"vdb_quads\": %zu}\n",
        name.c_str(), s.threads, millions, a, b, c, c / a, c / b, triangles, quads);
}

void measure_file(const std::string &name, const std::string &path, double isovalue,
                  const settings &s)
{
    cw_volume v;
    cw_error err;
    io::File file(path);
    file.open();
    const FloatGrid::Ptr grid =
        gridPtrCast<FloatGrid>(file.readGrid(file.beginName().gridName()));
    if (!grid || cw_volume_read(path.c_str(), nullptr, &v, nullptr, &err) != CW_OK) {
        std::fprintf(stderr, "%s: no grid of floats\n", path.c_str());
        return;
    }
    measure(name, *grid, v, isovalue, s);
    cw_volume_free(&v);
}

// A narrow band of values from the surface, distances near it: sin x cos y + ... within a ball.
FloatGrid::Ptr sponge(int radius)
{
    FloatGrid::Ptr grid = FloatGrid::create(3);
    const double k = 0.35;
    FloatGrid::Accessor at = grid->getAccessor();
    const CoordBBox box(Coord(-radius), Coord(radius));
    for (auto p = box.begin(); p; ++p) {
        const Vec3d x = k * (*p).asVec3d();
        const double gyroid =
            (std::sin(x[0]) * std::cos(x[1]) + std::sin(x[1]) * std::cos(x[2]) +
             std::sin(x[2]) * std::cos(x[0])) /
            k / 1.2;
        const double value = std::max(gyroid, (*p).asVec3d().length() - radius + 4);
        if (std::fabs(value) < 3)
            at.setValue(*p, float(value));
        else if (value <= -3)
            at.setValueOff(*p, -3);
    }
    grid->pruneGrid();
    grid->setGridClass(GRID_LEVEL_SET);
    return grid;
}

void measure_made(const std::string &name, const FloatGrid::Ptr &grid, const settings &s)
{
    const std::string path = "bench_sparse." + std::to_string(getpid()) + ".vdb";
    io::File(path).write({grid});
    measure_file(name, path, 0, s);
    std::remove(path.c_str());
}

} // namespace

int main(int argc, char **argv)
{
    settings s;
    int a = 1;
    for (; a + 1 < argc && argv[a][0] == '-'; a += 2) {
        int *value = std::strcmp(argv[a], "--threads") == 0 ? &s.threads
                     : std::strcmp(argv[a], "--runs") == 0  ? &s.runs
                                                            : nullptr;
        if (!value || (*value = std::atoi(argv[a + 1])) < 1)
            return std::fprintf(stderr, "unknown option, or no value: %s\n", argv[a]), 2;
    }
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      size_t(s.threads));
    initialize();
    std::fprintf(stderr, "%-16s %9s %9s %9s %9s %7s %7s %10s %10s\n", "case", "M active",
                 "plain ms", "normals", "vdb ms", "vdb/pl", "vdb/nrm", "triangles", "vdb");
    for (float radius : {80.f, 160.f, 310.f})
        measure_made(
            "sphere-" + std::to_string(int(radius)),
            tools::createLevelSetSphere<FloatGrid>(radius, Vec3f(0.1f, 0.2f, 0.3f), 1.f), s);
    measure_made("sponge-100", sponge(100), s);
    for (; a + 1 < argc; a += 2)
        measure_file(argv[a], argv[a], std::atof(argv[a + 1]), s);
    return 0;
}
