// Tests the C++ layer: owners, spans, errors as exceptions or not.
#undef NDEBUG
#include <cubewright/cubewright.hpp>

#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace cw = cubewright;

namespace
{

constexpr std::size_t SIZE = 24;

// Distances from a ball's surface, positive inside.
std::vector<float> make_ball()
{
    std::vector<float> voxels;
    for (std::size_t n = 0; n < SIZE * SIZE * SIZE; n++) {
        const double x = double(n % SIZE) - 11.5, y = double(n / SIZE % SIZE) - 11.5,
                     z = double(n / SIZE / SIZE) - 11.5;
        voxels.push_back(float(8 - std::sqrt(x * x + y * y + z * z)));
    }
    return voxels;
}

const std::vector<float> ball = make_ball();

cw::volume view_ball()
{
    return cw::view_volume(std::span(ball), {SIZE, SIZE, SIZE}, {1, 1, 2}, {10, 20, 30});
}

void test_spans_and_owners()
{
    const cw::volume volume = view_ball();
    cw::mesh mesh = cw::extract(volume, {.isovalue = 0});
    assert(mesh.triangles().size() == 3 * mesh->triangle_count && mesh->triangle_count > 1000);
    assert(mesh.normals().size() == mesh.positions().size());
    for (const std::uint32_t corner : mesh.triangles())
        assert(corner < mesh->vertex_count);
    cw::mesh moved = std::move(mesh);
    assert(mesh->triangle_count == 0 && mesh.positions().empty() &&
           moved->triangle_count > 1000);
    moved = std::move(*&moved);
    assert(moved->triangle_count > 1000);
    mesh = std::move(moved);
    cw_mesh raw = mesh.release();
    assert(raw.triangle_count > 1000 && mesh.triangles().empty());
    mesh = cw::mesh(raw);
    const cw_mesh view = cw::view_mesh(mesh.positions(), mesh.triangles());
    cw::call(cw_mesh_check, &view);
    cw_quality found{};
    cw::call(cw_quality_measure, &view, nullptr, &found);
    assert(found.open_edges == 0 && found.genus == 0);
}

void test_errors()
{
    cw_error err{};
    try {
        cw::read_mesh("missing.stl");
        assert(false);
    } catch (const cw::error &e) {
        assert(e.status() == CW_ERR_IO && std::string(e.what()).find("missing.stl") == 0);
    }
    assert(!cw::read_mesh("missing.stl", {}, err) &&
           std::string(err.message).find("missing.stl") == 0);
    assert(
        !cw::view_volume(std::span(ball), {SIZE, SIZE, SIZE + 1}, {1, 1, 1}, {0, 0, 0}, err));
    assert(std::string(err.message).find("number of voxels") != std::string::npos);
    assert(!cw::view_volume(std::span(ball), {0, SIZE, SIZE}, {1, 1, 1}, {0, 0, 0}, err));
    const auto volume =
        cw::view_volume(std::span(ball), {SIZE, SIZE, SIZE}, {1, 1, 1}, {0, 0, 0}, err);
    const auto mesh = cw::extract(*volume, {.isovalue = 0}, err);
    assert(mesh && (*mesh)->triangle_count > 0);
    assert(!cw::extract(*volume, {.snap = 2}, err) &&
           std::string(err.message).find("snap") == 0);
}

void test_memory()
{
    const cw::mesh mesh = cw::extract(view_ball(), {.isovalue = 0});
    const cw::bytes file = cw::write_mesh("ball.ply", mesh);
    const std::span<const std::byte> content = std::as_bytes(*file.get());
    assert(content.size() > 1000);
    const cw::mesh again = cw::read_mesh(content);
    assert(again->triangle_count == mesh->triangle_count);
    cw_error err{};
    assert(!cw::read_mesh(content.first(100), "part.ply", {}, err));
    assert(std::string(err.message).find("part.ply") == 0);
    assert(!cw::write_mesh("ball.xyz9", mesh, {}, err) &&
           !cw::read_volume(content, nullptr, {}, err));
    const std::vector<std::uint16_t> counts(8, 3);
    const cw::volume small = cw::view_volume(std::span(counts), {2, 2, 2});
    assert(small->type == CW_U16);
}

void test_progress()
{
    const cw::volume volume = view_ball();
    int calls = 0;
    const auto cancel = [&](const char *, double) { return ++calls < 1; };
    cw_error err{};
    assert(!cw::extract(volume, {.progress = cw::progress_of(cancel)}, err) && calls == 1);
    const auto fail = [](const char *, double) -> bool {
        throw std::runtime_error("of the caller");
    };
    try {
        cw::extract(volume, {.progress = cw::progress_of(fail)});
        assert(false);
    } catch (const cw::error &e) {
        assert(e.status() == CW_ERR_CANCELLED);
    }
}

void test_extractor()
{
    std::vector<float> voxels = ball;
    const cw::volume volume =
        cw::view_volume(std::span<const float>(voxels), {SIZE, SIZE, SIZE});
    const cw::extractor extractor = cw::make_extractor(volume);
    cw::mesh mesh;
    const cw_extract_desc desc{};
    cw::call(cw_extractor_extract, *extractor.get(), &desc, mesh.get(), nullptr);
    const std::size_t count = mesh->triangle_count;
    for (float &value : voxels)
        value -= 2;
    cw::call(cw_extractor_update, *extractor.get(), nullptr);
    cw::call(cw_extractor_extract, *extractor.get(), &desc, mesh.get(), nullptr);
    assert(mesh->triangle_count > 0 && mesh->triangle_count < count);
}

} // namespace

int main()
{
    test_spans_and_owners();
    test_errors();
    test_memory();
    test_progress();
    test_extractor();
    return cw_memory_used() == 0 ? 0 : 1;
}
