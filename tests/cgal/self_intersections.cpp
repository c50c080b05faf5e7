/* Does any extracted surface cross itself? Asked of CGAL, whose predicates are exact; also
 * after points with equal coordinates are merged, as readers of STL do. Prints one line a
 * family of volumes, and of each the first volume that fails; exits with 1 if more fail than
 * allowed.
 *
 * CGAL's Polygon Mesh Processing is under the GPL. This program is for testing, is linked into
 * nothing and never installed. */
#include "support/hostile.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <cubewright/cubewright.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <utility>
#include <vector>

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Point = std::array<float, 3>;

/* Per family: how many surfaces may be defective. 0 is the promise. */
struct Allowed {
    int whole, floats, cells, fields, hostile;
};
constexpr Allowed allowed = {0, 0, 0, 0, 0};

/* Triangles over points; positions stay relative to the origin, so they are exact. */
struct Soup {
    std::vector<Point> points;
    std::vector<std::array<uint32_t, 3>> triangles;
};

Soup to_soup(const cw_mesh &mesh)
{
    Soup soup;
    for (size_t v = 0; v < mesh.vertex_count; v++) {
        const float *p = mesh.positions + 3 * v;
        soup.points.push_back({p[0] + 0.f, p[1] + 0.f, p[2] + 0.f}); /* -0 becomes 0 */
    }
    for (size_t t = 0; t < mesh.triangle_count; t++) {
        const uint32_t *c = mesh.triangles + 3 * t;
        soup.triangles.push_back({c[0], c[1], c[2]});
    }
    return soup;
}

/* Equal points become one; false if there were none. */
bool weld(Soup &soup)
{
    std::map<Point, uint32_t> numbers;
    std::vector<uint32_t> merged;
    std::vector<Point> points;
    for (const Point &p : soup.points) {
        const auto found = numbers.emplace(p, static_cast<uint32_t>(points.size()));
        if (found.second)
            points.push_back(p);
        merged.push_back(found.first->second);
    }
    for (auto &t : soup.triangles)
        for (uint32_t &corner : t)
            corner = merged[corner];
    const bool changed = points.size() < soup.points.size();
    soup.points = std::move(points);
    return changed;
}

void print_triangle(const Soup &soup, size_t t)
{
    std::printf("    triangle %zu:", t);
    for (const uint32_t corner : soup.triangles[t]) {
        const Point &p = soup.points[corner];
        std::printf(" %u (%.9g %.9g %.9g)", corner, static_cast<double>(p[0]),
                    static_cast<double>(p[1]), static_cast<double>(p[2]));
    }
    std::printf("\n");
}

/* Decides whether a soup is defective: a triangle fits no manifold, has no area, or crosses
 * another. */
bool is_defective(const Soup &soup, bool print)
{
    Surface surface;
    for (const Point &p : soup.points)
        surface.add_vertex(Kernel::Point_3(static_cast<double>(p[0]), static_cast<double>(p[1]),
                                           static_cast<double>(p[2])));
    for (size_t t = 0; t < soup.triangles.size(); t++) {
        const auto &c = soup.triangles[t];
        const bool corners_differ = c[0] != c[1] && c[1] != c[2] && c[2] != c[0];
        if (corners_differ &&
            surface.add_face(Surface::Vertex_index(c[0]), Surface::Vertex_index(c[1]),
                             Surface::Vertex_index(c[2])) != Surface::null_face())
            continue;
        if (print) {
            std::printf("    does not fit a manifold:\n");
            print_triangle(soup, t);
        }
        return true;
    }
    if (!print)
        return CGAL::Polygon_mesh_processing::does_self_intersect(surface);
    std::vector<std::pair<Surface::Face_index, Surface::Face_index>> pairs;
    CGAL::Polygon_mesh_processing::self_intersections(surface, std::back_inserter(pairs));
    std::printf("    %zu pairs of triangles cross; the first:\n", pairs.size());
    if (!pairs.empty()) {
        print_triangle(soup, pairs[0].first);
        print_triangle(soup, pairs[0].second);
    }
    return !pairs.empty();
}

/* The judge is judged: a tetrahedron is well, and each of these is not. */
bool defects_are_seen()
{
    const std::vector<Point> base = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const Soup well = {base, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    Soup crossing = well, touching = well, twice = well, flat = well, folded = well;
    for (const Point &p : base) {
        crossing.points.push_back({p[0] + 0.1f, p[1] + 0.1f, p[2] + 0.1f});
        touching.points.push_back({p[0] + 1, p[1], p[2]});
    }
    for (const auto &t : well.triangles)
        for (Soup *soup : {&crossing, &touching})
            soup->triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
    twice.triangles.push_back(well.triangles[0]);
    flat.points[3] = {0.5f, 0.5f, 0};
    folded.points = {{0, 0, 0}, {1, 0, 0}, {0.2f, 1, 0}, {0.3f, 0.5f, 0}};
    folded.triangles = {{0, 1, 2}, {1, 0, 3}};
    bool seen = !is_defective(well, false);
    for (const Soup *soup : {&crossing, &touching, &twice, &flat, &folded})
        seen = seen && is_defective(*soup, false);
    if (!seen)
        std::printf("this program does not see what it looks for\n");
    return seen;
}

void print_volume(const cw_volume &v, const cw_extract_desc &desc, const char *how)
{
    std::printf("  %s, %s%s%s, snap %g, isovalue %.17g, %zu x %zu x %zu", how,
                desc.leave_open ? "open" : "closed", desc.inside_is_low ? ", low" : "",
                desc.simple_topology ? ", simple" : "", desc.snap, desc.isovalue, v.dim[0],
                v.dim[1], v.dim[2]);
    if (v.dim[0] * v.dim[1] * v.dim[2] <= 125)
        for (size_t k = 0; k < v.dim[2]; k++)
            for (size_t j = 0; j < v.dim[1]; j++)
                for (size_t i = 0; i < v.dim[0]; i++)
                    std::printf("%s%.9g", i + j + k ? ", " : ": ",
                                cw_volume_value(&v, i, j, k));
    std::printf("\n");
}

/* Counts surfaces of one family of volumes. */
class Tally
{
public:
    Tally(const char *name, int allowed_defects) : name_(name), allowed_(allowed_defects)
    {
    }

    /* Adds a volume as it is, and snapped: alternately so that most needles go, or all that
     * may. */
    void add(const cw_volume &volume, const cw_extract_desc &desc)
    {
        cw_extract_desc snapped = desc;
        snapped.snap = turn_++ / 2 % 2 ? 0.5 : 0.3;
        add_one(volume, desc);
        add_one(volume, snapped);
    }

    /* As indexed and, where that differs, welded. */
    void add_one(const cw_volume &volume, const cw_extract_desc &desc)
    {
        cw_mesh mesh = {};
        cw_error err = {};
        if (cw_extract(&volume, &desc, &mesh, nullptr, &err) != CW_OK) {
            std::printf("%s: %s\n", name_, err.message);
            defective_ = allowed_ + 1;
            return;
        }
        Soup soup = to_soup(mesh);
        cw_mesh_free(&mesh);
        judge(soup, volume, desc, "as indexed");
        if (weld(soup))
            judge(soup, volume, desc, "welded");
    }

    void add_closed_and_open(const cw_volume &volume, double isovalue)
    {
        for (const bool open : {false, true}) {
            cw_extract_desc desc = {};
            desc.isovalue = isovalue;
            desc.leave_open = open;
            add(volume, desc);
        }
    }

    /* Names the volumes that follow. */
    void about(const char *what)
    {
        about_ = what;
    }

    bool passes() const
    {
        std::printf("%s: %d surfaces, %d defective, %d allowed\n", name_, surfaces_, defective_,
                    allowed_);
        std::fflush(stdout);
        return defective_ <= allowed_;
    }

private:
    void judge(const Soup &soup, const cw_volume &volume, const cw_extract_desc &desc,
               const char *how)
    {
        surfaces_++;
        if (!is_defective(soup, false))
            return;
        if (defective_++ == 0) {
            std::printf("  %s\n", about_);
            print_volume(volume, desc, how);
            is_defective(soup, true);
        }
    }

    const char *name_, *about_ = "";
    int allowed_, turn_ = 0, surfaces_ = 0, defective_ = 0;
};

/* xorshift: the same numbers everywhere. */
double next_unit()
{
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return static_cast<double>(state >> 11) / 9007199254740992.0;
}

/* Extracts `rounds` cubes of samples, each by a function of the round and the sample. */
bool grids_pass(const char *name, int allowed_defects, int rounds, size_t side,
                const std::function<double(int, size_t)> &value)
{
    Tally tally(name, allowed_defects);
    for (int round = 0; round < rounds; round++) {
        std::vector<float> voxels;
        for (size_t n = 0; n < side * side * side; n++)
            voxels.push_back(static_cast<float>(value(round, n)));
        cw_volume v = {};
        v.data = voxels.data();
        v.type = CW_F32;
        v.dim[0] = v.dim[1] = v.dim[2] = side;
        tally.add_closed_and_open(v, 0);
    }
    return tally.passes();
}

/* Without noise most clusters are snapped, with it many cannot be. */
bool fields_pass()
{
    static const std::pair<cw_field, double> rows[] = {
        {CW_FIELD_SPHERE, 2}, {CW_FIELD_GYROID, 0.3}, {CW_FIELD_CT_HEAD, 60},
        {CW_FIELD_TORUS, 0},  {CW_FIELD_GYROID, 0},   {CW_FIELD_MARSCHNER_LOBB, 0}};
    Tally tally("fields", allowed.fields);
    for (const auto &row : rows) {
        cw_field_desc desc = {};
        cw_volume v = {};
        cw_error err = {};
        desc.field = row.first;
        desc.dim[0] = desc.dim[1] = desc.dim[2] = 32;
        desc.type = row.first == CW_FIELD_CT_HEAD ? CW_I16 : CW_F32;
        desc.noise = row.second;
        if (cw_field_sample(&desc, &v, &err) != CW_OK) {
            std::printf("fields: %s\n", err.message);
            return false;
        }
        tally.add_closed_and_open(v, cw_field_isovalue(row.first));
        cw_volume_free(&v);
    }
    return tally.passes();
}

/* Where it stands every setting, and one in each of the other frames. */
void add_hostile(Tally &tally, size_t row, cw_volume &v)
{
    const test_frame *frame;
    for (size_t f = 0; (frame = test_frame_at(f)) != nullptr; f++)
        for (size_t n = 0; n < 16; n++) {
            if (f > 0 && n != (row + f) % 16)
                continue;
            cw_extract_desc desc = {};
            desc.isovalue = test_hostile_at(row)->isovalue;
            desc.leave_open = n & 1;
            desc.inside_is_low = n & 2;
            desc.simple_topology = n & 4;
            desc.cubic_placement = n & 8;
            tally.about(test_hostile_at(row)->name);
            std::memcpy(v.affine, frame->affine, sizeof v.affine);
            tally.add(v, desc);
        }
}

bool hostile_pass()
{
    Tally tally("hostile volumes", allowed.hostile);
    for (size_t row = 0; test_hostile_at(row); row++) {
        cw_volume v = {};
        cw_error err = {};
        if (test_hostile_make(test_hostile_at(row), &v, &err) != CW_OK) {
            std::printf("%s: %s\n", test_hostile_at(row)->name, err.message);
            return false;
        }
        add_hostile(tally, row, v);
        cw_volume_free(&v);
    }
    return tally.passes();
}

/* Decides whether a label's surface is defective, also after its points are welded. */
bool is_label_defective(const cw_label_surfaces &surfaces, uint32_t label)
{
    cw_mesh mesh = {};
    cw_error err = {};
    if (cw_label_mesh(&surfaces, label, &mesh, &err) != CW_OK)
        return true;
    Soup soup = to_soup(mesh);
    cw_mesh_free(&mesh);
    weld(soup);
    return is_defective(soup, false);
}

size_t count_defective(const cw_label_surfaces &surfaces)
{
    size_t defective = 0;
    for (size_t n = 0; n < surfaces.label_count; n++)
        defective += is_label_defective(surfaces, surfaces.labels[n].label);
    return defective;
}

/* Random maps of 2 to 50 labels, unsmoothed, smoothed, and simplified to a fifth. */
bool labels_pass(int maps)
{
    size_t surfaces_seen = 0, defective = 0;
    for (int map = 0; map < maps; map++) {
        const size_t side = 4 + static_cast<size_t>(6 * next_unit());
        const int labels = 2 + static_cast<int>(49 * next_unit());
        std::vector<uint32_t> voxels(side * side * side);
        for (uint32_t &v : voxels)
            v = static_cast<uint32_t>(labels * next_unit());
        cw_volume volume = {};
        volume.data = voxels.data();
        volume.type = CW_U32;
        volume.dim[0] = volume.dim[1] = volume.dim[2] = side;
        for (int how = 0; how < 3; how++) {
            cw_label_surfaces surfaces, simple;
            cw_error err = {};
            cw_labels_desc desc = {};
            desc.no_smoothing = how == 0;
            cw_status st = cw_extract_labels(&volume, &desc, &surfaces, &err);
            if (st == CW_OK && how == 2) {
                cw_label_simplify_desc fifth = {};
                fifth.ratio = 0.2;
                st = cw_label_simplify(&surfaces, &fifth, &simple, &err);
                cw_label_surfaces_free(&surfaces);
                surfaces = simple;
            }
            if (st != CW_OK) {
                std::printf("labels: %s\n", err.message);
                return false;
            }
            surfaces_seen += surfaces.label_count;
            defective += count_defective(surfaces);
            cw_label_surfaces_free(&surfaces);
        }
    }
    std::printf("labels: %zu surfaces, %zu defective\n", surfaces_seen, defective);
    return defective == 0;
}

double whole_value(int, size_t)
{
    return std::floor(5 * next_unit()) - 2;
}

double float_value(int, size_t)
{
    return 2 * next_unit() - 1;
}

/* Every pattern of signs, its magnitudes over six decades, near one, or all one. */
double cell_value(int round, size_t n)
{
    const int kind = round / 256 % 3;
    const double magnitude = kind == 0   ? std::pow(10, -6 * next_unit())
                             : kind == 1 ? 0.1 + next_unit()
                                         : 1;
    return round % 256 >> n & 1 ? magnitude : -magnitude;
}

} // namespace

/* self_intersections [FACTOR]: extracts FACTOR times as many grids, for a longer look. */
int main(int argc, char **argv)
{
    const int factor = argc > 1 ? std::atoi(argv[1]) : 1;
    bool pass = defects_are_seen();
    pass = grids_pass("whole numbers", allowed.whole, 300 * factor, 5, whole_value) && pass;
    pass = grids_pass("random floats", allowed.floats, 300 * factor, 5, float_value) && pass;
    pass = grids_pass("single cells", allowed.cells, 256 * 6 * factor, 2, cell_value) && pass;
    pass = fields_pass() && pass;
    pass = hostile_pass() && pass;
    pass = labels_pass(20 * factor) && pass;
    return pass ? 0 : 1;
}
