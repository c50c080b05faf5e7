// Writes the vertices on the edges of each block that the surface crosses, and the triangles of its
// cells, but of cells with vertices inside: these get their places.
layout(local_size_x = 64) in;
layout(std430, binding = 10) readonly buffer OpenFirst
{
    uint open_first[];
};
shared uint edges[1536], rows[81], part[64], cells[512], places[512];

// ---- vertices --------------------------------------------------------------------------------

#if TYPE == U32 || TYPE == I32
#define REAL  double
#define REAL3 dvec3
#define HALF  0.5LF
const REAL DIGITS_LOST = 1e-290LF;
#else
#define REAL  float
#define REAL3 vec3
#define HALF  1.0
const REAL DIGITS_LOST = 1e-30;
#endif

REAL held(uint bits)
{
#if TYPE == F32
    return uintBitsToFloat(bits);
#elif TYPE == U32
    return double(bits) * HALF;
#elif TYPE == I32
    return double(int(bits)) * HALF;
#else
    return float(int(bits));
#endif
}

// The difference of the samples around one, or twice the one-sided one at the border.
REAL difference(ivec3 v, int axis)
{
    ivec3 along = ivec3(axis == 0, axis == 1, axis == 2);
    bool before = v[axis] > 0, after = v[axis] + 1 < DIM[axis];
    REAL low = held(bits_at(before ? v - along : v)),
         high = held(bits_at(after ? v + along : v));
    precise REAL d = high - low;
    return before && after ? d : d + d;
}

REAL power_beside(REAL x)
{
#if TYPE == U32 || TYPE == I32
    uint bits = unpackDouble2x32(x).y;
    return packDouble2x32(uvec2(0u, 0x7fe00000u - (bits & 0x7ff00000u)));
#else
    return uintBitsToFloat(0x7f000000u - (floatBitsToUint(x) & 0x7f800000u));
#endif
}

// Finds the normal from differences at both ends, in the precision of extract/dense. Returns false
// where it is not usable.
bool find_normal(ivec3 v, int axis, double share, out vec3 normal)
{
    ivec3 to = v + ivec3(axis == 0, axis == 1, axis == 2);
    precise REAL3 g = REAL3(0.0), d = REAL3(0.0);
    REAL t = REAL(share);
    for (int a = 0; a < 3; a++) {
        REAL p = difference(v, a), q = difference(to, a);
        precise REAL step = q - p;
        step = t * step;
        step = p + step;
        g.x = a == 0 ? step : g.x;
        g.y = a == 1 ? step : g.y;
        g.z = a == 2 ? step : g.z;
    }
    for (int r = 0; r < 3; r++) {
        precise REAL x = REAL(COFACTOR(r, 0)) * g.x, y = REAL(COFACTOR(r, 1)) * g.y,
                     z = REAL(COFACTOR(r, 2)) * g.z;
        precise REAL sum = axis == 2 ? z + x : x + y; // the edge's own axis comes first
        sum = axis == 2 ? sum + y : sum + z;
        if (DIAGONAL)
            sum = r == 0 ? x : r == 1 ? y : z;
        sum = sum + REAL(0.0);
        d.x = r == 0 ? sum : d.x;
        d.y = r == 1 ? sum : d.y;
        d.z = r == 2 ? sum : d.z;
    }
    precise REAL sum = abs(d.x) + abs(d.y);
    sum = sum + abs(d.z);
    d = d * power_beside(sum);
    precise REAL square = d.x * d.x + d.y * d.y;
    square = square + d.z * d.z;
#if TYPE == U32 || TYPE == I32
    REAL scale = quotient(1.0LF, root_of(square));
#else
    // rounded once, as by a processor: GPUs' own roots and quotients are only nearly right
    REAL root = float(root_of(double(square)));
    REAL scale = float(quotient(1.0LF, double(root)));
#endif
    d = d * scale;
    normal = vec3(float(d.x), float(d.y), float(d.z));
    return sum > DIGITS_LOST && square > REAL(0.0) && !isinf(square) && !isnan(square);
}

// Computes half the difference of the samples around one along an axis, one-sided where a neighbour
// is missing or infinite.
double slope_at(ivec3 v, int axis, uint center)
{
    ivec3 along = ivec3(axis == 0, axis == 1, axis == 2);
    uint before, after;
    bool has_before = fetch(v - along, before) && is_finite(before);
    bool has_after = fetch(v + along, after) && is_finite(after);
    precise double low = number_of(before) * 0.5LF, high = number_of(after) * 0.5LF,
                   middle = number_of(center) * 0.5LF, d = 0.0LF;
    if (has_before && has_after)
        d = high - low;
    else if (is_finite(center) && has_after)
        d = 2.0LF * (high - middle);
    else if (is_finite(center) && has_before)
        d = 2.0LF * (middle - low);
    return d;
}

// Returns true if a voxel and the six around it exist and have values.
bool is_among_values(ivec3 v)
{
    uint bits;
    bool all_there = fetch(v, bits);
    for (int a = 0; a < 3 && all_there; a++) {
        ivec3 along = ivec3(a == 0, a == 1, a == 2);
        all_there = fetch(v - along, bits) && fetch(v + along, bits);
    }
    return all_there;
}

void write_vertex(uint n, ivec3 at, int axis, uint slot, uint edge)
{
    ivec3 v = at - 1, along = ivec3(axis == 0, axis == 1, axis == 2), to = v + along;
    uint a, b;
    bool has_a = fetch(v, a), has_b = fetch(to, b);
    bool within = is_within(v) && is_within(to);
    double share = edge_crossing(has_a, a, has_b, b);
    dvec3 x = dvec3(0.0LF);
    set(x, axis, share);
    store_position(n, at, x);
    vec3 normal;
    if (!within && !HAS_NODATA) {
        int side = v[axis] >= 0 ? 1 : 0, first = 6 * axis + 3 * side;
        store_normal(n, vec3(caps[first], caps[first + 1], caps[first + 2]));
        return;
    }
    bool usual = within && has_a && has_b;
    if (usual && HAS_NODATA)
        usual = is_among_values(v) && is_among_values(to);
    if (usual && find_normal(v, axis, share, normal)) {
        store_normal(n, normal);
        return;
    }
    dvec3 g = dvec3(0.0LF);
    if (has_a && has_b) {
        for (int c = 0; c < 3; c++) {
            precise double p = slope_at(v, c, a), q = slope_at(to, c, b);
            precise double step = q - p;
            step = share * step;
            p = p + step;
            set(g, c, p);
        }
    } else {
        set(g, axis, has_a == INVERT ? 1.0LF : -1.0LF);
    }
    store_gradient(n, g, slot, edge);
}

// ---- cells -----------------------------------------------------------------------------------

// Returns the sum of all threads before this one.
uint scan_rows(uint t, uint mine)
{
    part[t] = mine;
    barrier();
    for (uint step = 1u; step < 64u; step *= 2u) {
        uint before = t >= step ? part[t - step] : 0u;
        barrier();
        part[t] += before;
        barrier();
    }
    uint sum = part[t] - mine;
    barrier();
    return sum;
}

// Triangles in the lower 16 bits, and vertices inside, of a plan: as live_plan.glsl counts them.
uint count_parts(uint code)
{
    uint word = tables[256u + 8u * (code & 1023u)], count = word >> 23 & 31u,
         inner = word >> 28 & 7u;
    if (code >> 10 != 0u) {
        inner += 3u;
        for (int i = 0; i < 2; i++) {
            uint loop = (code >> (13 + 6 * i) & 7u) - 1u;
            uint cone = word >> (19u + loop) & 1u;
            count += 3u + (cone != 0u ? 0u : 2u);
            inner -= cone;
        }
    }
    return count | inner << 16;
}

void write_triangles(uint first, uint config, uint count, uint near[8], ivec3 cell)
{
    for (uint n = 0u; n < count; n++) {
        uint corner[3];
        for (uint c = 0u; c < 3u; c++)
            corner[c] = cell_vertex(near, cell, int(config_edge(config, 3u * n + c)));
        uint to = 3u * (first + n);
        indices[to] = corner[0];
        indices[to + 1u] = corner[FLIP ? 2 : 1];
        indices[to + 2u] = corner[FLIP ? 1 : 2];
    }
}

void main()
{
    uint slot = group_number(), t = gl_LocalInvocationIndex;
    if (slot >= min(totals[ACTIVE], SLOT_CAPACITY))
        return;
    uint at = slot * RECORD, near[8];
    ivec3 first = first_sample(active_blocks[slot]);
    uvec2 base = bases[slot];
    find_slots(slot, near);
    if (t < 48u) {
        uint word = records[at + t];
        uint to = records[at + RANKS + (t >> 1)] >> (16u * (t & 1u)) & 0xffffu;
        for (; word != 0u; word &= word - 1u)
            edges[to++] = t / 16u << 9 | t % 16u << 5 | uint(findLSB(word));
    }
    if (t < 27u) {
        uint three = records[at + ROWS + t];
        for (uint n = 0u; n < 3u; n++)
            rows[3u * t + n] = three >> (9u * n) & 511u;
    }
    barrier();
    uint edge_count = records[at + EDGES];
    for (uint n = t; n < edge_count; n += 64u) {
        uint e = edges[n];
        write_vertex(base.x + n, first + ivec3(e & 7u, e >> 3 & 7u, e >> 6 & 7u), int(e >> 9),
                     slot, e);
    }

    uint r = t / 8u * 9u + t % 8u;
    uint r00 = rows[r], r10 = rows[r + 1u], r01 = rows[r + 9u], r11 = rows[r + 10u];
    uint some = r00 | r10 | r01 | r11, every = r00 & r10 & r01 & r11;
    uint mixed = (some | some >> 1) & ~(every & every >> 1) & 255u, open = 0u;
    for (uint left = mixed; left != 0u; left &= left - 1u) {
        uint i = uint(findLSB(left));
        uint cube = (r00 >> i & 3u) | (r10 >> i & 3u) << 2 | (r01 >> i & 3u) << 4 |
                    (r11 >> i & 3u) << 6;
        open |= (tables[cube] >> 10 & 1u) << i;
    }
    // how many cells, and how many open ones, are in rows before
    uint before = scan_rows(t, uint(bitCount(mixed)) | uint(bitCount(open)) << 16);
    uint open_at = open_first[slot] + (before >> 16), cell_at = before & 0xffffu, parts = 0u;
    uint o = open_at;
    for (uint left = mixed; left != 0u; left &= left - 1u) {
        uint i = uint(findLSB(left));
        uint cube = (r00 >> i & 3u) | (r10 >> i & 3u) << 2 | (r01 >> i & 3u) << 4 |
                    (r11 >> i & 3u) << 6;
        parts +=
            (open >> i & 1u) != 0u ? count_parts(open_cells[o++].y) : tables[cube] >> 17 & 7u;
    }
    uint placed = scan_rows(t, parts);
    uint triangle = base.y + (placed & 0xffffu), vertex = base.x + edge_count + (placed >> 16);
    o = open_at;
    for (uint left = mixed; left != 0u; left &= left - 1u) {
        uint i = uint(findLSB(left)), cell = t << 3 | i;
        uint cube = (r00 >> i & 3u) | (r10 >> i & 3u) << 2 | (r01 >> i & 3u) << 4 |
                    (r11 >> i & 3u) << 6;
        uint config = tables[cube] & 1023u, count = tables[cube] >> 17 & 7u;
        if ((open >> i & 1u) != 0u) {
            uint code = open_cells[o].y, both = count_parts(code);
            config = code & 1023u;
            count = both & 0xffffu;
            if (both >> 16 != 0u) {
                open_cells[o].z = triangle;
                open_cells[o].w = vertex;
                vertex += both >> 16;
                triangle += count;
                count = 0u; // live_build.glsl writes them
            }
            o++;
        }
        cells[cell_at] = cell | config << 9 | count << 19;
        places[cell_at++] = triangle;
        triangle += count;
    }
    if (t == 63u)
        part[0] = cell_at;
    barrier();
    uint cell_count = part[0];
    for (uint n = t; n < cell_count; n += 64u) {
        uint cell = cells[n];
        write_triangles(places[n], cell >> 9 & 1023u, cell >> 19, near,
                        ivec3(cell & 7u, cell >> 3 & 7u, cell >> 6 & 7u));
    }
}
