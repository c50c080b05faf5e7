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

double values[8]; // of the corners, minus the isovalue, positive inside
bool finite[8], known[8];
uint cube;

// ---- faces -----------------------------------------------------------------------------------

// The error of a product in double precision, exactly [Dekker1971].
double product_error(double a, double b, double product)
{
    precise double big = 134217729.0LF * a;
    precise double a_high = big - (big - a);
    precise double a_low = a - a_high;
    big = 134217729.0LF * b;
    precise double b_high = big - (big - b);
    precise double b_low = b - b_high;
    precise double error = a_high * b_high - product;
    error = error + a_high * b_low;
    error = error + a_low * b_high;
    error = error + a_low * b_low;
    return error;
}

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
    int sign = compare_products(values[i0], values[i1], values[o0], values[o1]);
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
double root[4]; // where a column changes sign; 2: nowhere
double event[6];
int event_column[6], event_count;

bool is_in(int corner)
{
    return (cube >> corner & 1u) != 0u;
}

int column_corner(int n, double t)
{
    return t < root[n] ? columns[n] : columns[n] + 4;
}

bool root_is_before(int m, int n)
{
    bool m_leaves = is_in(columns[m]), n_leaves = is_in(columns[n]);
    if ((m - n) % 2 == 0 || m_leaves == n_leaves)
        return root[m] < root[n];
    return n_leaves == is_joined(faces_after[(m + 1) % 4 == n ? m : n]);
}

void add_event(double t, int column)
{
    int i = event_count++;
    for (; i > 1 && column >= 0 && root_is_before(column, event_column[i - 1]); i--) {
        event[i] = event[i - 1];
        event_column[i] = event_column[i - 1];
    }
    event[i] = t;
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
        root[n] = 2.0LF;
        if (is_in(columns[n]) != is_in(columns[n] + 4)) {
            precise double low = values[columns[n]], high = values[columns[n] + 4];
            precise double at = low / (low - high);
            root[n] = at;
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

Extended column_slope(int n)
{
    return subtract(extend(values[columns[n] + 4]), extend(values[columns[n]]));
}

bool turns_back(int inside, bool starts_joined, double t, double u)
{
    Extended a = extend(values[columns[inside]]), c = extend(values[columns[inside + 2]]);
    Extended b = extend(values[columns[1 - inside]]), d = extend(values[columns[3 - inside]]);
    Extended da = column_slope(inside), dc = column_slope(inside + 2),
             db = column_slope(1 - inside), dd = column_slope(3 - inside);
    Extended A = subtract(multiply(da, dc), multiply(db, dd));
    if (starts_joined ? sign_of(A) <= 0 : sign_of(A) >= 0)
        return false;
    Extended B = subtract(subtract(add(multiply(a, dc), multiply(c, da)), multiply(b, dd)),
                          multiply(d, db));
    Extended C = subtract(multiply(a, c), multiply(b, d));
    Extended at = divide(negate(B), scale_by(A, 1));
    if (sign_of(subtract(at, extend(t))) <= 0 || sign_of(subtract(at, extend(u))) >= 0)
        return false;
    int q = sign_of(add(C, scale_by(multiply(at, B), -1)));
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
    precise double a = values[low] - values[low + 4], b = values[high - 4] - values[high];
    precise double p = values[low] / a, q = values[high - 4] / b;
    return p <= q;
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
        precise double t = event[e], u = event[e + 1];
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
        values[c] = INVERT ? -difference : difference;
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
