// Resolves the cells whose signs do not settle the surface, one a thread, as
// core/cases/cell_topology.c does: which of their faces join, and whether they have a tunnel.
layout(local_size_x = 64) in;
layout(std430, binding = 4) readonly buffer Active
{
    uint active_blocks[];
};
layout(std430, binding = 6) buffer Counts
{
    uvec2 counts[];
};
layout(std430, binding = 9) buffer OpenCells
{
    uvec4 open_cells[];
};
layout(std430, binding = 13) readonly buffer Tables
{
    uint tables[];
};

uvec2 value_bits[8]; // of the corners, minus the isovalue, positive inside
bool finite[8], known[8];
uint cube;

double value_of(int corner)
{
    return unpack(value_bits[corner]);
}

// ---- faces -----------------------------------------------------------------------------------

// The sign of a c - b d.
int compare_products(double a, double c, double b, double d)
{
    precise double ac = a * c, bd = b * d;
    if (ac != bd)
        return ac > bd ? 1 : -1;
    double e = product_error(a, c, ac), f = product_error(b, d, bd);
    return int(e > f) - int(e < f);
}

int face_corner(int face, int n)
{
    int axis = face >> 1, side = face & 1;
    int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    int turn = side != 0 ? n : 3 - n;
    return side << axis | (turn == 1 || turn == 2 ? u : 0) | (turn >= 2 ? v : 0);
}

bool face_is_joined(int face)
{
    int c[4];
    for (int n = 0; n < 4; n++)
        c[n] = face_corner(face, n);
    int first = int(cube >> c[0] & 1u) ^ 1; // of the inside corners
    int i0 = c[first], i1 = c[first + 2], o0 = c[1 - first], o1 = c[3 - first];
    if (!finite[o0] || !finite[o1])
        return false;
    if (!finite[i0] || !finite[i1])
        return true;
    int sign = compare_products(value_of(i0), value_of(i1), value_of(o0), value_of(o1));
    return sign > 0 || (sign == 0 && ZERO_INSIDE);
}

uint joined; // bit n: face n is ambiguous, and its inside corners are joined

void join_faces(uint faces)
{
    joined = 0u;
    for (; faces != 0u; faces &= faces - 1u) {
        int face = findLSB(faces);
        joined |= face_is_joined(face) ? 1u << face : 0u;
    }
}

bool is_joined(int face)
{
    return (joined >> face & 1u) != 0u;
}

// ---- tunnels ---------------------------------------------------------------------------------

const int columns[4] = int[4](0, 1, 3, 2), faces_after[4] = int[4](2, 1, 3, 0);
uvec2 root_bits[4]; // where a column changes sign; 2: nowhere
uvec2 event_bits[6];
int event_column[6], event_count;

double root_at(int column)
{
    return unpack(root_bits[column]);
}

double event_at(int e)
{
    return unpack(event_bits[e]);
}

bool is_in(int corner)
{
    return (cube >> corner & 1u) != 0u;
}

int column_corner(int n, double t)
{
    return t < root_at(n) ? columns[n] : columns[n] + 4;
}

bool root_is_before(int m, int n)
{
    bool m_leaves = is_in(columns[m]), n_leaves = is_in(columns[n]);
    if ((m - n) % 2 == 0 || m_leaves == n_leaves)
        return root_at(m) < root_at(n);
    return n_leaves == is_joined(faces_after[(m + 1) % 4 == n ? m : n]);
}

void add_event(double t, int column)
{
    int i = event_count++;
    for (; i > 1 && column >= 0 && root_is_before(column, event_column[i - 1]); i--) {
        event_bits[i] = event_bits[i - 1];
        event_column[i] = event_column[i - 1];
    }
    event_bits[i] = pack(t);
    event_column[i] = column;
}

bool start_sweep()
{
    event_count = 0;
    for (int c = 0; c < 8; c++)
        if (!finite[c])
            return false;
    add_event(0.0LF, -1);
    for (int n = 0; n < 4; n++) {
        root_bits[n] = pack(2.0LF);
        if (is_in(columns[n]) != is_in(columns[n] + 4)) {
            precise double low = value_of(columns[n]), high = value_of(columns[n] + 4);
            precise double height = low - high;
            double at = quotient(low, height);
            root_bits[n] = pack(at);
            add_event(at, n);
        }
    }
    add_event(1.0LF, -2);
    return true;
}

bool joined_at(int e, int inside)
{
    int column = event_column[e];
    if (column >= 0)
        return (column - inside) % 2 != 0;
    return is_joined(column == -1 ? 4 : 5);
}

// Steps of turns_back(): what is done, where the result goes, and with what. Registers 0 to 3 are
// the lower ends of four columns, a c b d, 4 to 7 their upper ends and then slopes, 14 and 15 the
// bounds. They run in one loop, as compilers copy functions to wherever they are called.
#define TIMES                0
#define PLUS                 1
#define MINUS                2
#define PEAK                 3 // minus a register, by twice another
#define HALF_OF              4 // a register, plus half of another
#define STEP(what, to, x, y) (what | to << 4 | x << 8 | y << 12)
const int step_count = 20, slope_step = 6; // after which the sign of A is known
const int steps[20] = int[20](
    STEP(MINUS, 4, 4, 0), STEP(MINUS, 5, 5, 1), STEP(MINUS, 6, 6, 2), STEP(MINUS, 7, 7, 3),
    STEP(TIMES, 8, 4, 5), STEP(TIMES, 9, 6, 7), STEP(MINUS, 8, 8, 9), // A
    STEP(TIMES, 9, 0, 5), STEP(TIMES, 10, 1, 4), STEP(PLUS, 9, 9, 10), STEP(TIMES, 10, 2, 7),
    STEP(MINUS, 9, 9, 10), STEP(TIMES, 10, 3, 6), STEP(MINUS, 9, 9, 10),   // B
    STEP(TIMES, 10, 0, 1), STEP(TIMES, 11, 2, 3), STEP(MINUS, 10, 10, 11), // C
    STEP(PEAK, 11, 9, 8), STEP(TIMES, 12, 11, 9), STEP(HALF_OF, 12, 10, 12));

bool turns_back(int inside, bool starts_joined, double t, double u)
{
    Extended r[16];
    int column[4] = int[4](inside, inside + 2, 1 - inside, 3 - inside);
    for (int n = 0; n < 4; n++) {
        r[n] = extend(value_of(columns[column[n]]));
        r[4 + n] = extend(value_of(columns[column[n]] + 4));
    }
    r[14] = extend(t);
    r[15] = extend(u);
    for (int n = 0; n < step_count + ZERO; n++) {
        int step = steps[n], what = step & 15;
        Extended x = r[step >> 8 & 15], y = r[step >> 12 & 15], z;
        if (what == TIMES) {
            z = multiply(x, y);
        } else if (what == PEAK) {
            z = divide(negate(x), scale_by(y, 1));
        } else {
            y.negative = y.negative != (what == MINUS);
            z = add(x, scale_by(y, what == HALF_OF ? -1 : 0));
        }
        r[step >> 4 & 15] = z;
        if (n == slope_step && (starts_joined ? sign_of(z) <= 0 : sign_of(z) >= 0))
            return false;
    }
    if (!is_below(r[14], r[11]) || !is_below(r[11], r[15]))
        return false;
    int q = sign_of(r[12]);
    return starts_joined ? q < 0 || (q == 0 && !ZERO_INSIDE) : q > 0 || (q == 0 && ZERO_INSIDE);
}

// ---- configurations, eight words each after the 256 cases --------------------------------------

uint config_at;

int loop_count()
{
    return int(tables[config_at] & 7u);
}

int loop_length(int l)
{
    return int(tables[config_at] >> (3 + 4 * l) & 15u);
}

bool is_cone(int l)
{
    return (tables[config_at] >> (19 + l) & 1u) != 0u;
}

int patch_of(int corner)
{
    return int(tables[config_at + 1u] >> (3 * corner) & 7u);
}

int loop_edge(int n)
{
    return int(tables[config_at + 2u + uint(n) / 8u] >> (4 * (n % 8)) & 15u);
}

int edge_corner(int edge)
{
    int low = edge & 1, high = edge >> 1 & 1;
    return edge < 4 ? low << 1 | high << 2 : edge < 8 ? low | high << 2 : low | high << 1;
}

int find_loop(int patch_a, int other)
{
    int at = 0;
    for (int l = 0; l < loop_count(); at += loop_length(l++)) {
        int edge = loop_edge(at), low = edge_corner(edge), high = low | 1 << (edge >> 2);
        int p = patch_of(low), q = patch_of(high);
        if ((p == patch_a && q == other) || (p == other && q == patch_a))
            return l;
    }
    return -1;
}

const uint all_low[3] = uint[3](0x55u, 0x33u, 0x0fu),
           even_low[3] = uint[3](0x41u, 0x21u, 0x09u);

bool may_alternate(int axis)
{
    uint even = even_low[axis], odd = all_low[axis] ^ even, ends = cube >> (1 << axis);
    uint inside = cube | ends, outside = ~(cube & ends);
    return ((inside & even) == even && (outside & odd) == odd) ||
           ((inside & odd) == odd && (outside & even) == even);
}

bool columns_pass(uint faces)
{
    uint alone = bitCount(cube) == 2 ? cube : ~cube & 255u;
    int low = findLSB(alone), high = 7 - low;
    if (faces != 0u || loop_count() != 2)
        return false;
    if (!(finite[low] && finite[low + 4] && finite[high - 4] && finite[high]))
        return false;
    precise double a = value_of(low) - value_of(low + 4),
                   b = value_of(high - 4) - value_of(high);
    return quotient(value_of(low), a) <= quotient(value_of(high - 4), b);
}

// Packs a plan as cwi_cell_plan_pack() does.
uint plan_cell(uint faces, uint config)
{
    uint code = config;
    config_at = 256u + 8u * config;
    if (loop_count() < 2 || !may_alternate(0) || !may_alternate(1) || !may_alternate(2) ||
        columns_pass(faces) || !start_sweep())
        return code;
    for (int e = 0; e + 1 < event_count; e++) {
        precise double t = event_at(e), u = event_at(e + 1);
        precise double middle = 0.5LF * (t + u);
        bool inside[4];
        for (int n = 0; n < 4; n++)
            inside[n] = is_in(column_corner(n, middle));
        if (!(t < u) || inside[0] == inside[1] || inside[0] != inside[2] ||
            inside[1] != inside[3])
            continue;
        int first = inside[0] ? 0 : 1;
        bool starts_joined = joined_at(e, first);
        if (starts_joined != joined_at(e + 1, first) || !turns_back(first, starts_joined, t, u))
            continue;
        int column = starts_joined ? 1 - first : first;
        int ends[2] = int[2](column_corner(column, middle), column_corner(column + 2, middle));
        int around = column_corner(1 - column, middle), loops[2];
        for (int i = 0; i < 2; i++)
            loops[i] = find_loop(patch_of(ends[i]), patch_of(around));
        if (loops[0] < 0 || loops[1] < 0 || loops[0] == loops[1])
            return code;
        int m = loop_length(loops[0]), n = loop_length(loops[1]);
        if (m != 3 && n != 3 && (m != 4 || n != 4))
            return code;
        for (int i = 0; i < 2; i++)
            code |= uint((loops[i] + 1) << 3 | ends[i]) << (10 + 6 * i);
        return code;
    }
    return code;
}

// Triangles and vertices inside of a plan.
uvec2 count_parts(uint code)
{
    uint word = tables[256u + 8u * (code & 1023u)];
    uvec2 parts = uvec2(word >> 23 & 31u, word >> 28 & 7u);
    if (code >> 10 == 0u)
        return parts;
    parts.y += 3u;
    for (int i = 0; i < 2; i++) {
        int loop = int(code >> (13 + 6 * i) & 7u) - 1;
        uint cone = word >> (19 + loop) & 1u, length = word >> (3 + 4 * loop) & 15u;
        parts.x += length + 3u - (length - (cone != 0u ? 0u : 2u));
        parts.y -= cone;
    }
    return parts;
}

void main()
{
    uint n = group_number() * 64u + gl_LocalInvocationIndex;
    if (n >= min(totals[OPEN], OPEN_CAPACITY))
        return;
    uint slot = open_cells[n].x >> 9;
    int cell = int(open_cells[n].x & 511u);
    ivec3 first = first_sample(active_blocks[slot]) + ivec3(cell, cell >> 3, cell >> 6) % 8 - 1;
    cube = 0u;
    for (int c = 0; c < 8; c++) {
        uint bits;
        known[c] = fetch(first + ivec3(c & 1, c >> 1 & 1, c >> 2), bits);
        finite[c] = known[c] && is_finite(bits);
        precise double difference = number_of(bits) - LEVEL;
        value_bits[c] = pack(INVERT ? -difference : difference);
        cube |= known[c] && is_inside(bits) ? 1u << c : 0u;
    }
    uint faces = tables[cube] >> 11 & 63u, config = tables[cube] & 1023u, bit = 0u;
    join_faces(faces);
    for (uint left = faces; left != 0u; left &= left - 1u, bit++)
        config += is_joined(findLSB(left)) ? 1u << bit : 0u;
    uint code = plan_cell(faces, config);
    uvec2 parts = count_parts(code);
    open_cells[n].y = code;
    atomicAdd(counts[slot].x, parts.y);
    atomicAdd(counts[slot].y, parts.x);
}
