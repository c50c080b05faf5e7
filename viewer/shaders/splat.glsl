// Draws a Gaussian blob's footprint [Westover1990], an ellipse by the linearised map of its
// place to the picture [Zwicker2001]. It adds the absorption to a sheet: optical depth, and
// colour times that. With NODES it also draws the part of a node in a sheet: a rectangle of the
// lattice, blurred as its voxels would be, so that adjacent nodes leave no seam.
#ifdef NODES
// Returns the step through index space, per unit, of a ray through a point of eye space.
vec3 slope_through(vec3 at)
{
    return mat3(index_from_eye) * (view.x > 0.5 ? normalize(at) : vec3(0.0, 0.0, -1.0));
}
#endif

uniform int axis; // that sheets are across
#ifdef VERTEX
uniform samplerBuffer splats; // three texels each, see viewer/modes/splat_sheets.h
uniform float sigma, radius;  // of the blob of one voxel, in voxels; of the table, in sigmas
uniform float cell;           // volume of a voxel in eye space
out vec2 offset;              // from the middle, in sigmas; of nodes in voxels
flat out vec4 node;           // half its sizes, reach of its blur; 0: a voxel
flat out float far_away;
out vec3 on_ray; // the point in eye space
out vec4 color;  // times the extinction; extinction; both times the height or density

// The blob's covariance on the picture: of J A A^T J^T.
mat2 covariance(vec3 at)
{
    mat3 a = mat3(eye_from_index);
    float d = -at.z;
    mat3x2 j = view.x > 0.5 ? mat3x2(1.0 / d, 0.0, 0.0, 1.0 / d, at.x / (d * d), at.y / (d * d))
                            : mat3x2(1.0, 0.0, 0.0, 1.0, 0.0, 0.0);
    mat3x2 m = sigma * (j * a);
    return m * transpose(m);
}

// Widened to at least half a pixel, so that the samples of the picture do not miss it.
mat2 widen(mat2 c)
{
    float pixel = 2.0 * picture.w / picture.y;
    float middle = 0.5 * (c[0][0] + c[1][1]);
    float least = middle - sqrt(max(middle * middle - determinant(c), 0.0));
    return c + mat2(max(0.25 * pixel * pixel - least, 0.0));
}

vec4 shine(vec4 row, vec3 gradient, vec3 at)
{
    vec3 slope = mat3(gradient_to_eye) * gradient;
#ifdef FACTOR
    row.a *= gradient_factor(slope);
#endif
#ifdef LIT
    row.rgb = shade(row.rgb, slope, view.x > 0.5 ? normalize(-at) : vec3(0.0, 0.0, 1.0));
#endif
    return row;
}

vec2 corner()
{
    return 2.0 * vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) - 1.0;
}

void place_voxel(vec3 at, vec4 row, float mass)
{
    mat2 c = widen(covariance(at));
    float first = sqrt(c[0][0]), mixed = c[0][1] / first; // the root of c, after Cholesky
    float second = sqrt(max(c[1][1] - mixed * mixed, 1e-30));
    offset = radius * corner();
    vec2 way = vec2(first * offset.x, mixed * offset.x + second * offset.y);
    vec3 beam = view.x > 0.5 ? at / -at.z : vec3(0.0, 0.0, -1.0);
    vec2 middle = view.x > 0.5 ? beam.xy : at.xy;
    float spread = view.x > 0.5 ? length(beam) / (at.z * at.z) : 1.0;
    float depth = mass * cell * spread * row.a / (first * second);
    vec4 plane = projection * vec4(0.0, 0.0, at.z, 1.0);
    color = vec4(row.rgb * depth, depth);
    node = vec4(0.0);
    on_ray = at;
    gl_Position = vec4((middle + way) / picture.zw, plane.z / plane.w, 1.0);
}

#ifdef NODES
// Places a node. A voxel's blob along a ray, measured in the sheet, is wider for oblique rays.
void place_node(vec3 index, vec3 at, vec4 row, float mass, vec3 size)
{
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    vec3 slope = slope_through(at);
    vec2 lean = vec2(slope[b], slope[c]) / slope[axis];
    node = vec4(0.5 * size[b], 0.5 * size[c], sigma * sqrt(5.0 * (1.0 + lean * lean)));
    offset = (node.xy + node.zw) * corner();
    index[b] += offset.x;
    index[c] += offset.y;
    vec3 place = (eye_from_index * vec4(index, 1.0)).xyz;
    color = vec4(row.rgb, 1.0) * (mass * row.a);
    on_ray = place;
    gl_Position = projection * vec4(place, 1.0);
}
#endif

void main()
{
    int n = 3 * (gl_VertexID / 4);
    vec4 place = texelFetch(splats, n), slope = texelFetch(splats, n + 1);
    vec3 at = (eye_from_index * vec4(place.xyz, 1.0)).xyz;
    vec4 row = shine(classify(place.w), slope.xyz, at);
    far_away = -at.z;
#ifdef NODES
    vec4 size = texelFetch(splats, n + 2);
    if (size.w > 0.5) {
        place_node(place.xyz, at, row, slope.w, size.xyz);
        return;
    }
#endif
    place_voxel(at, row, slope.w);
}
#else
uniform sampler2D footprint; // by the square of the distance, 0 to 1 at its end
uniform float radius;
in vec2 offset;
flat in vec4 node;
flat in float far_away;
in vec3 on_ray;
in vec4 color;
out vec4 result;

#ifdef NODES
// The blur along one axis: a parabola as wide as the Gaussian, whose integral is cheap.
float cover(float x, float reach, float blur)
{
    return smoothstep(-blur, blur, x + reach) - smoothstep(-blur, blur, x - reach);
}
#endif

// Returns the height of the footprint; for a node, multiplied by the way through the sheet.
float height()
{
#ifdef NODES
    if (node.z > 0.0)
        return cover(offset.x, node.x, node.z) * cover(offset.y, node.y, node.w) /
               abs(slope_through(on_ray)[axis]);
#endif
    float at = dot(offset, offset) / (radius * radius);
    return at < 1.0 ? texture(footprint, vec2((at * 255.0 + 0.5) / 256.0, 0.5)).r : 0.0;
}

void main()
{
    float share = height();
    if (!(share > 0.0))
        discard;
    result = color * share;
    if (view.w > 0.0)
        result = attenuate(result, far_away, gl_FragCoord.y / picture.y);
}
#endif
