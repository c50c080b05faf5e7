// Wraps OpenVDB in plain C: distances of voxels from a mesh. Signs are not taken from OpenVDB:
// it fills enclosed hollows, even those that the mesh has.
#include "extract/level_set/openvdb_distance_wrap.h"
#include "core/base/guard.hpp"
#include "core/base/thread_pool.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

struct cwi_distances {
    openvdb::FloatGrid::Ptr grid;
    std::vector<const openvdb::FloatTree::LeafNodeType *> leaves;
    int threads;
};

namespace
{

// The adapter that OpenVDB has compiled itself: any other takes a minute and a half to compile.
using triangles = openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I>;
static_assert(sizeof(openvdb::Vec3I) == 3 * sizeof(uint32_t));

std::vector<openvdb::Vec3s> in_voxels(const cwi_distances_desc &d)
{
    std::vector<openvdb::Vec3s> points(d.mesh->vertex_count);
    const float *from = d.mesh->positions;
    for (auto &p : points)
        for (int a = 0; a < 3; a++)
            p[a] = float((double(*from++) - d.first[a]) / d.voxel_mm);
    return points;
}

// Progress, on the calling thread only; the others see that it was cancelled.
class interruption : public openvdb::util::NullInterrupter
{
public:
    explicit interruption(const cw_progress &progress)
        : to(progress), caller(std::this_thread::get_id())
    {
    }

    bool wasInterrupted(int percent = -1) override
    {
        if (to.report && std::this_thread::get_id() == caller) {
            last = percent >= 0 ? percent : last;
            if (!cancelled && !to.report(to.user, "distances", last / 100.0))
                cancelled = true;
        }
        return cancelled;
    }

    std::atomic<bool> cancelled{false};

private:
    const cw_progress to;
    const std::thread::id caller;
    int last = 0;
};

// Returns the threads that TBB may use: it ends the process when the system gives it fewer. Those
// that it has made stay.
int find_threads(int requested)
{
    static std::mutex lock;
    static int granted = 1;
    const std::lock_guard<std::mutex> guard(lock);
    if (requested > granted)
        granted += cwi_try_threads(requested - granted);
    return std::min(requested, granted);
}

using at_most = tbb::global_control;
constexpr auto parallelism = tbb::global_control::max_allowed_parallelism;

cw_status open(const cwi_distances_desc *desc, cwi_distances **out, cw_error *err)
{
    return cw::guard(err, "OpenVDB", [&] {
        const int count = find_threads(desc->threads);
        const at_most threads(parallelism, size_t(count));
        interruption stop(desc->progress);
        const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
        auto made = std::make_unique<cwi_distances>();
        const float reach = float(desc->reach);
        made->threads = count;
        const auto points = in_voxels(*desc);
        const triangles mesh(points.data(), points.size(),
                             reinterpret_cast<const openvdb::Vec3I *>(desc->mesh->triangles),
                             desc->mesh->triangle_count);
        made->grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
            stop.interrupter(), mesh, *transform, reach, reach,
            openvdb::tools::UNSIGNED_DISTANCE_FIELD);
        if (stop.cancelled)
            return cwi_fail(err, CW_ERR_CANCELLED, "interrupted while distances were found");
        for (auto leaf = made->grid->tree().cbeginLeaf(); leaf; ++leaf)
            made->leaves.push_back(&*leaf);
        *out = made.release();
        return CW_OK;
    });
}

size_t leaves(const cwi_distances *distances)
{
    return distances->leaves.size();
}

void take(const cwi_distances *distances, size_t n, int32_t at[3], float voxels[512])
{
    const auto &leaf = *distances->leaves[n];
    for (int a = 0; a < 3; a++)
        at[a] = leaf.origin()[a] >> 3;
    for (openvdb::Index z = 0; z < 8; z++)
        for (openvdb::Index y = 0; y < 8; y++)
            for (openvdb::Index x = 0; x < 8; x++)
                *voxels++ = leaf.getValue(x << 6 | y << 3 | z);
}

void close(cwi_distances *distances)
{
    if (!distances)
        return;
    const at_most threads(parallelism, size_t(distances->threads));
    delete distances;
}

} // namespace

extern "C" const cwi_levelset_functions cwi_module_levelset = {open, leaves, take, close};
