// A Gaussian blob's footprint [Westover1990], an ellipse by the linearised map of its place to the
// picture [Zwicker2001]. It adds what it absorbs to a sheet: optical depth, and colour times that.
#ifdef VERTEX
uniform samplerBuffer splats; // three texels each, see viewer/splats.h
uniform float sigma, radius;  // of the blob of one voxel, in voxels; of the table, in sigmas
uniform float cell;           // volume of a voxel in eye space
out vec2 offset;              // from the middle, in sigmas
flat out float far_away;
flat out vec4 color;          // times the extinction; extinction; both times the footprint's height

// The blob's covariance on the picture: of J A S S A^T J^T, S its size.
mat2 covariance(vec3 at, vec3 size)
{
    mat3 a = mat3(eye_from_index);
    float d = -at.z;
    mat3x2 j = view.x > 0.5 ? mat3x2(1.0 / d, 0.0, 0.0, 1.0 / d, at.x / (d * d), at.y / (d * d))
                            : mat3x2(1.0, 0.0, 0.0, 1.0, 0.0, 0.0);
    mat3x2 m = j * a;
    m[0] *= sigma * size.x;
    m[1] *= sigma * size.y;
    m[2] *= sigma * size.z;
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

void main()
{
    int n = 3 * (gl_VertexID / 4);
    vec4 place = texelFetch(splats, n), slope = texelFetch(splats, n + 1);
    vec3 at = (eye_from_index * vec4(place.xyz, 1.0)).xyz;
    mat2 c = widen(covariance(at, texelFetch(splats, n + 2).xyz));
    float first = sqrt(c[0][0]), mixed = c[0][1] / first; // the root of c, a triangle [Cholesky]
    float second = sqrt(max(c[1][1] - mixed * mixed, 1e-30));
    offset = radius * (2.0 * vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) - 1.0);
    vec2 way = vec2(first * offset.x, mixed * offset.x + second * offset.y);
    vec3 beam = view.x > 0.5 ? at / -at.z : vec3(0.0, 0.0, -1.0);
    vec2 middle = view.x > 0.5 ? beam.xy : at.xy;
    float spread = view.x > 0.5 ? length(beam) / (at.z * at.z) : 1.0;
    vec4 row = shine(classify(place.w), slope.xyz, at);
    float depth = slope.w * cell * spread * row.a / (first * second);
    color = vec4(row.rgb * depth, depth);
    vec4 flat_at = projection * vec4(0.0, 0.0, at.z, 1.0);
    gl_Position = vec4((middle + way) / picture.zw, flat_at.z / flat_at.w, 1.0);
    far_away = -at.z;
}
#else
uniform sampler2D footprint; // by the square of the distance, 0 to 1 at its end
uniform float radius;
in vec2 offset;
flat in float far_away;
flat in vec4 color;
out vec4 result;

void main()
{
    float at = dot(offset, offset) / (radius * radius);
    if (at >= 1.0)
        discard;
    result = color * texture(footprint, vec2((at * 255.0 + 0.5) / 256.0, 0.5)).r;
    if (view.w > 0.0)
        result = attenuate(result, far_away, gl_FragCoord.y / picture.y);
}
#endif
