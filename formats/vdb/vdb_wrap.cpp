// Wraps OpenVDB behind plain C: a file's grids, their leaves and tiles. It starts no thread,
// since the process may not.
#include "core/base/guard.hpp"

extern "C" {
#include "formats/vdb/vdb.h"
}

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <streambuf>
#include <tuple>
#include <type_traits>
#include <unistd.h>
#include <vector>

namespace
{

using openvdb::GridBase;

// A stream buffer over a file descriptor; OpenVDB's own would open a path.
class descriptor_buffer : public std::streambuf
{
public:
    descriptor_buffer(int file, int64_t length) : fd(file), size(length), bytes(1 << 16)
    {
    }

protected:
    int_type underflow() override
    {
        at += egptr() - eback();
        setg(nullptr, nullptr, nullptr);
        const ssize_t got = pread(fd, bytes.data(), bytes.size(), at);
        if (got <= 0)
            return traits_type::eof();
        setg(bytes.data(), bytes.data(), bytes.data() + got);
        return traits_type::to_int_type(*gptr());
    }

    pos_type seekoff(off_type to, std::ios_base::seekdir from, std::ios_base::openmode) override
    {
        const off_type here = at + (gptr() - eback());
        return move(to + (from == std::ios_base::cur   ? here
                          : from == std::ios_base::end ? size
                                                       : 0));
    }

    pos_type seekpos(pos_type to, std::ios_base::openmode) override
    {
        return move(off_type(to));
    }

private:
    pos_type move(off_type to)
    {
        if (to < 0 || to > size)
            return pos_type(off_type(-1));
        setg(nullptr, nullptr, nullptr);
        at = to;
        return pos_type(to);
    }

    int fd;
    int64_t size, at = 0; // offset of the buffer's first byte
    std::vector<char> bytes;
};

// A grid whose tree is freed without TBB. TBB's threads do not exist in the forked process, and
// none may be started there. Freeing an empty tree does not need them.
class held_grid
{
public:
    held_grid() = default;
    explicit held_grid(GridBase::Ptr grid) : held(std::move(grid))
    {
    }
    held_grid(held_grid &&other) = default;
    held_grid &operator=(held_grid &&other)
    {
        std::swap(held, other.held);
        return *this;
    }
    ~held_grid()
    {
        if (held)
            held->apply<openvdb::GridTypes>([](auto &grid) { grid.tree().root().clear(); });
    }
    explicit operator bool() const
    {
        return bool(held);
    }
    GridBase &operator*() const
    {
        return *held;
    }
    GridBase *operator->() const
    {
        return held.get();
    }

private:
    GridBase::Ptr held;
};

// A file version that this OpenVDB does not know; it would only guess at the layout.
struct unknown_version {
    uint32_t number;
};

// A file's grids in their order, as openvdb::io::Stream reads them, but without voxels, or with
// those of only one grid.
class archive : public openvdb::io::Archive
{
public:
    archive(int fd, int64_t size) : buffer(fd, size), in(&buffer)
    {
        in.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
        readHeader(in);
        if (fileVersion() < openvdb::OPENVDB_FILE_VERSION_ROOTNODE_MAP ||
            fileVersion() > openvdb::OPENVDB_FILE_VERSION)
            throw unknown_version{fileVersion()};
        openvdb::io::setStreamMetadataPtr(in, stream, false);
        openvdb::io::setVersion(in, libraryVersion(), fileVersion());
        openvdb::io::setDataCompression(in, compression());
        openvdb::MetaMap file;
        file.readMeta(in);
        count = std::max(readGridCount(in), 0);
    }

    // Reads the next grid, without voxels; returns none where its type is not known.
    held_grid next(openvdb::io::GridDescriptor &about)
    {
        held_grid grid = begin(about);
        if (!grid)
            return grid;
        grid->setSaveFloatAsHalf(about.saveFloatAsHalf());
        if (inputHasGridOffsets())
            about.seekToGrid(in);
        readGridCompression(in);
        stream->setHalfFloat(about.saveFloatAsHalf());
        grid->readMeta(in);
        openvdb::io::setGridClass(in, grid->getGridClass());
        const bool late = fileVersion() < openvdb::OPENVDB_FILE_VERSION_GRID_INSTANCING;
        if (!late)
            grid->readTransform(in);
        if (late || !about.isInstance())
            grid->readTopology(in);
        if (late)
            grid->readTransform(in);
        return grid;
    }

    // Reads the grid's voxels, or skips them to the next grid.
    void finish(const openvdb::io::GridDescriptor &about, const held_grid &grid, bool voxels)
    {
        if (grid && !about.isInstance() && (voxels || !inputHasGridOffsets()))
            grid->readBuffers(in);
        if (inputHasGridOffsets())
            about.seekToEnd(in);
    }

    int32_t count;

private:
    // Reads a grid's description. At an unknown type OpenVDB stops before the file offsets.
    held_grid begin(openvdb::io::GridDescriptor &about)
    {
        try {
            return held_grid(about.read(in));
        } catch (const openvdb::LookupError &) {
            int64_t offsets[3]; // offsets of the grid, its voxels, its end
            in.read(reinterpret_cast<char *>(offsets), sizeof offsets);
            about.setEndPos(offsets[2]);
            if (!inputHasGridOffsets())
                throw;
            return held_grid();
        }
    }

    descriptor_buffer buffer;
    std::istream in;
    openvdb::io::StreamMetadata::Ptr stream{new openvdb::io::StreamMetadata};
};

// The parts of a tree that are read, in the order in which they are returned.
struct content {
    std::vector<cw_tile> tiles;
    std::vector<const void *> leaves;
    int64_t low[3], high[3];
    uint64_t active = 0;
    double background = 0;
};

void take_box(content &c, const openvdb::Coord &origin, int64_t size, uint32_t at[3])
{
    for (int a = 0; a < 3; a++) {
        const int64_t leaf = origin[a] >> 3;
        c.low[a] = std::min(c.low[a], leaf);
        c.high[a] = std::max(c.high[a], leaf + size - 1);
        at[a] = uint32_t(leaf + (int64_t(1) << 29)); // temporarily, so that all are positive
    }
}

// Joins tiles of one value that touch along an axis and have the same size across it.
void join_tiles(std::vector<cw_tile> &tiles, int axis)
{
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto key = [=](const cw_tile &t) {
        return std::make_tuple(t.size[u], t.size[v], t.at[u], t.at[v], t.at[axis]);
    };
    std::sort(tiles.begin(), tiles.end(),
              [=](const cw_tile &a, const cw_tile &b) { return key(a) < key(b); });
    size_t kept = 0;
    for (const cw_tile &t : tiles) {
        cw_tile *last = kept ? &tiles[kept - 1] : nullptr;
        if (last && std::memcmp(&last->value, &t.value, sizeof t.value) == 0 &&
            last->size[u] == t.size[u] && last->size[v] == t.size[v] &&
            last->at[u] == t.at[u] && last->at[v] == t.at[v] &&
            last->at[axis] + last->size[axis] == t.at[axis])
            last->size[axis] += t.size[axis];
        else
            tiles[kept++] = t;
    }
    tiles.resize(kept);
}

// Masks have only active states, no values; in leaves the states are read as values.
template <typename Tree>
constexpr bool is_mask = std::is_same<typename Tree::BuildType, openvdb::ValueMask>::value;

template <typename Tree> void take_tiles(const Tree &tree, content &c)
{
    auto it = tree.cbeginValueAll();
    it.setMaxDepth(Tree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; it; ++it) {
        const openvdb::CoordBBox box = it.getBoundingBox();
        const bool on = it.isValueOn();
        const double value = is_mask<Tree> ? double(on) : double(it.getValue());
        const uint32_t size = uint32_t(box.dim()[0]) >> 3;
        if (on)
            c.active += uint64_t(size) * size * size * 512;
        if (std::memcmp(&value, &c.background, sizeof value) == 0)
            continue;
        cw_tile tile = {{0, 0, 0}, {size, size, size}, value};
        take_box(c, box.min(), size, tile.at);
        c.tiles.push_back(tile);
    }
    for (int axis = 2; axis >= 0; axis--)
        join_tiles(c.tiles, axis);
}

template <typename Tree> content content_of(const Tree &tree)
{
    content c;
    uint32_t at[3];
    c.background = double(tree.background());
    for (int a = 0; a < 3; a++) {
        c.low[a] = INT32_MAX;
        c.high[a] = INT32_MIN;
    }
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        c.leaves.push_back(&*leaf);
        c.active += leaf->onVoxelCount();
        take_box(c, leaf->origin(), 1, at);
    }
    take_tiles(tree, c);
    for (cw_tile &t : c.tiles)
        for (int a = 0; a < 3; a++)
            t.at[a] -= uint32_t(c.low[a] + (int64_t(1) << 29));
    return c;
}

// Calls f(tree, type) for a grid of one number per voxel; returns false for others.
template <typename Grid, typename F> bool try_type(const GridBase &grid, cw_type type, F &&f)
{
    if (!grid.isType<Grid>())
        return false;
    f(static_cast<const Grid &>(grid).tree(), type);
    return true;
}

template <typename F> bool with_tree(const GridBase &grid, F &&f)
{
    return try_type<openvdb::FloatGrid>(grid, CW_F32, f) ||
           try_type<openvdb::DoubleGrid>(grid, CW_F64, f) ||
           try_type<openvdb::Int32Grid>(grid, CW_I32, f) ||
           try_type<openvdb::BoolGrid>(grid, CW_U8, f) ||
           try_type<openvdb::MaskGrid>(grid, CW_U8, f);
}

template <typename Leaf, typename T>
void put_voxels(const std::vector<const void *> &leaves, size_t first, size_t count, T *to)
{
    for (size_t n = first; n < first + count; n++) {
        const Leaf *leaf = static_cast<const Leaf *>(leaves[n]);
        for (openvdb::Index z = 0; z < 8; z++)
            for (openvdb::Index y = 0; y < 8; y++)
                for (openvdb::Index x = 0; x < 8; x++)
                    *to++ = T(leaf->getValue(x << 6 | y << 3 | z));
    }
}

// The state of the process: the file, and the last grid that was read with its voxels.
struct state {
    int fd = -1;
    int64_t size = 0;
    held_grid grid;
    size_t number = 0; // number of that grid
    content held;
};

void put_text(const std::string &from, char *to, size_t capacity)
{
    std::snprintf(to, capacity, "%s", from.c_str());
}

void put_affine(const GridBase &grid, cwi_vdb_grid &f)
{
    if (!grid.transform().isLinear()) {
        put_text("its transform is not linear", f.refusal, sizeof f.refusal);
        return;
    }
    const openvdb::Mat4R m = grid.transform().baseMap()->getAffineMap()->getMat4();
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            f.affine[r][c] = m(c, r);
}

void put_content(const GridBase &grid, cwi_vdb_grid &f)
{
    const bool known = with_tree(grid, [&](const auto &tree, cw_type type) {
        const content c = content_of(tree);
        f.type = type;
        f.leaf_count = c.leaves.size();
        f.tile_count = c.tiles.size();
        f.active = c.active;
        f.background = c.background;
        std::copy(c.low, c.low + 3, f.low);
        std::copy(c.high, c.high + 3, f.high);
    });
    if (!known)
        put_text("its values are of type " + grid.valueType() +
                     "; one number a voxel was expected: float, double, int32, bool or mask",
                 f.refusal, sizeof f.refusal);
}

void put_facts(const GridBase &grid, const openvdb::io::GridDescriptor &about, cwi_vdb_grid &f)
{
    const openvdb::GridClass kind = grid.getGridClass();
    put_text(grid.getName().empty() ? about.gridName() : grid.getName(), f.name, sizeof f.name);
    if (kind != openvdb::GRID_UNKNOWN)
        put_text(GridBase::gridClassToString(kind), f.kind, sizeof f.kind);
    f.level_set = kind == openvdb::GRID_LEVEL_SET;
    f.half = about.saveFloatAsHalf();
    if (about.isInstance())
        put_text("it shares the voxels of grid '" + about.instanceParentName() + "'", f.refusal,
                 sizeof f.refusal);
    else
        put_content(grid, f);
    if (!f.refusal[0])
        put_affine(grid, f);
}

void put_unknown(const openvdb::io::GridDescriptor &about, cwi_vdb_grid &f)
{
    put_text(about.gridName(), f.name, sizeof f.name);
    put_text("its type " + about.gridType() + " is not known", f.refusal, sizeof f.refusal);
}

// Runs a function as cw::guard(), with messages for files that end too early or have another
// version.
template <typename Body> cw_status guard_file(cw_error *err, Body &&body)
{
    return cw::guard(err, "OpenVDB", [&] {
        try {
            return body();
        } catch (const unknown_version &version) {
            return cwi_fail(err, CW_ERR_FORMAT, "its file version is %u; %u to %u are read",
                            version.number,
                            unsigned(openvdb::OPENVDB_FILE_VERSION_ROOTNODE_MAP),
                            unsigned(openvdb::OPENVDB_FILE_VERSION));
        } catch (const std::ios_base::failure &) {
            return cwi_fail(err, CW_ERR_FORMAT,
                            "it is damaged: it ends, or points beyond its end, "
                            "where there should be more of a grid");
        }
    });
}

cw_status list(state &s, void *shared, cw_error *err)
{
    return guard_file(err, [&] {
        auto *facts = static_cast<cwi_vdb_facts *>(shared);
        archive file(s.fd, s.size);
        facts->grid_count = uint32_t(file.count);
        for (int32_t n = 0; n < std::min<int32_t>(file.count, CWI_VDB_MAX_GRIDS); n++) {
            openvdb::io::GridDescriptor about;
            facts->grid[n] = cwi_vdb_grid{};
            const held_grid grid = file.next(about);
            if (grid)
                put_facts(*grid, about, facts->grid[n]);
            else
                put_unknown(about, facts->grid[n]);
            file.finish(about, grid, false);
        }
        return CW_OK;
    });
}

void load(state &s, size_t number)
{
    archive file(s.fd, s.size);
    for (size_t n = 0; n <= number; n++) {
        openvdb::io::GridDescriptor about;
        s.grid = file.next(about);
        file.finish(about, s.grid, n == number);
    }
    if (!s.grid)
        throw openvdb::ValueError("the file changed");
    with_tree(*s.grid, [&](const auto &tree, cw_type) { s.held = content_of(tree); });
    s.number = number;
}

template <typename Leaf> void put_places(const content &c, size_t first, size_t count, void *to)
{
    auto *at = static_cast<uint32_t(*)[3]>(to);
    for (size_t n = first; n < first + count; n++, at++)
        for (int a = 0; a < 3; a++)
            (*at)[a] =
                uint32_t((static_cast<const Leaf *>(c.leaves[n])->origin()[a] >> 3) - c.low[a]);
}

template <typename Tree>
void put_rows(const state &s, const Tree &, cw_type type, const cwi_plane_request &q, void *to)
{
    using Leaf = typename Tree::LeafNodeType;
    const content &c = s.held;
    const uint32_t plane = q.plane % CWI_VDB_PLANES;
    const size_t all = plane == CWI_VDB_TILES ? c.tiles.size() : c.leaves.size();
    if (q.first_row > all || q.row_count > all - q.first_row)
        throw openvdb::ValueError("the file changed");
    if (plane == CWI_VDB_TILES)
        std::copy_n(c.tiles.begin() + q.first_row, q.row_count, static_cast<cw_tile *>(to));
    else if (plane == CWI_VDB_LEAVES)
        put_places<Leaf>(c, q.first_row, q.row_count, to);
    else if (type == CW_F32)
        put_voxels<Leaf>(c.leaves, q.first_row, q.row_count, static_cast<float *>(to));
    else if (type == CW_F64)
        put_voxels<Leaf>(c.leaves, q.first_row, q.row_count, static_cast<double *>(to));
    else if (type == CW_I32)
        put_voxels<Leaf>(c.leaves, q.first_row, q.row_count, static_cast<int32_t *>(to));
    else
        put_voxels<Leaf>(c.leaves, q.first_row, q.row_count, static_cast<uint8_t *>(to));
}

cw_status read_rows(state &s, const cwi_plane_request &q, void *shared, cw_error *err)
{
    return guard_file(err, [&] {
        if (!s.grid || s.number != q.plane / CWI_VDB_PLANES)
            load(s, q.plane / CWI_VDB_PLANES);
        with_tree(*s.grid,
                  [&](const auto &tree, cw_type type) { put_rows(s, tree, type, q, shared); });
        return CW_OK;
    });
}

void close_file(state &s)
{
    if (s.fd >= 0)
        close(s.fd);
    s.fd = -1;
    s.held = content();
    s.grid = held_grid();
}

void *state_new()
{
    return new (std::nothrow) state;
}

void state_free(void *p)
{
    close_file(*static_cast<state *>(p));
    delete static_cast<state *>(p);
}

cw_status prepare(cw_error *err)
{
    return cw::guard(err, "OpenVDB", [&] {
        openvdb::initialize();
        return CW_OK;
    });
}

cw_status work(void *p, int fd, const void *request, void *shared, cw_error *err)
{
    state &s = *static_cast<state *>(p);
    const auto &q = *static_cast<const cwi_plane_request *>(request);
    if (q.op == CWI_PLANE_PIXELS)
        return read_rows(s, q, shared, err);
    close_file(s);
    s.fd = fd;
    s.size = int64_t(q.file_bytes);
    return list(s, shared, err);
}

} // namespace

extern "C" const cwi_plane_functions cwi_module_openvdb = {state_new, state_free, prepare,
                                                           work};
