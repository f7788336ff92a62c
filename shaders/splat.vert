#version 330 core
// A point becomes a splat. Permutations:
//   colour: VERTEX_COLOUR, VALUE_COLOUR, HEIGHT_COLOUR, SHADED_HEIGHT_COLOUR, or none for one colour;
//   kind: none for a square of a constant size; ADAPTIVE a square as large as the point's sphere; AFFINE and DISC the point's disc,
//     found in splat.frag; FITTED an ellipse by the point's surroundings;
//   PARABOLOID (of ADAPTIVE): a round splat whose depth grows from the centre on, so that of several splats the one whose centre is nearest
//     is seen;
//   ORTHOGRAPHIC (of DISC, FITTED and PARABOLOID): parallel rays;
//   QUADS: drawn as an instanced strip of four vertices in place of a point: points have a largest size, and vanish when their centre
//     leaves the clip volume;
//   DOUBLE (of DISC): values common to a splat's fragments are computed in double;
//   CLIPS: points that a clip hides are not drawn;
//   SELECTED: points whose x has a minus sign, 0 included, have another colour; their place is the same without it.
//
// `reference` is a point of the chunk near the eye, in the chunk's coordinates, exact in float; `translation` is where
// it lies in eye space, computed in double. Near the reference the subtraction is exact, so the rounding error of
// the result shrinks with the distance from the eye, wherever on earth and however large the chunk is.
#if defined(DOUBLE)
#extension GL_ARB_gpu_shader_fp64 : require
#define real double
#define rvec2 dvec2
#define rvec3 dvec3
#define rmat3 dmat3
#else
#define real float
#define rvec2 vec2
#define rvec3 vec3
#define rmat3 mat3
#endif

#if defined(SELECTED)
layout(location = 0) in vec3 place_and_sign;
#define position vec3(abs(place_and_sign.x), place_and_sign.yz)
#else
layout(location = 0) in vec3 position;
#endif

uniform vec3 reference;
uniform rmat3 to_eye;
uniform rvec3 translation;
uniform mat4 projection;

// Red, green, blue; and alpha, as mark_of() makes it where a splat is as wide everywhere.
flat out vec4 splat_colour;

#if defined(VERTEX_COLOUR)
layout(location = 1) in vec4 colour;
uniform vec2 tone;  // a factor and an exponent; (1, 1) leaves the bits of a colour as they are
vec3 colour_of_point() { return tone == vec2(1.0) ? colour.rgb : pow(min(colour.rgb * tone.x, vec3(1.0)), vec3(tone.y)); }
#elif defined(HEIGHT_COLOUR) || defined(SHADED_HEIGHT_COLOUR) || defined(VALUE_COLOUR)
uniform vec3 ramp[17];     // at even steps
uniform vec3 ramp_place;   // a value is at the place (value * x + y) ^ z, from 0 to 1

vec3 ramp_colour(float value)
{
    float t = clamp(value * ramp_place.x + ramp_place.y, 0.0, 1.0);
    if (ramp_place.z != 1.0) t = pow(t, ramp_place.z);
    float s = t * 16.0;
    int i = int(min(s, 15.0));
    return mix(ramp[i], ramp[i + 1], s - float(i));
}
#if defined(VALUE_COLOUR)
layout(location = 1) in float value;
vec3 colour_of_point() { return value < -1e25 ? vec3(0.4) : ramp_colour(value); }  // not a number: grey
#elif defined(SHADED_HEIGHT_COLOUR)
layout(location = 1) in float value;
uniform float value_exponent;
// Dark enough to be seen next to bright ones, and bright enough for their hue.
vec3 colour_of_point() { return ramp_colour(position.z) * mix(0.5, 1.0, pow(clamp(value, 0.0, 1.0), value_exponent)); }
#else
vec3 colour_of_point() { return ramp_colour(position.z); }
#endif
#else
uniform vec3 uniform_colour;
vec3 colour_of_point() { return uniform_colour; }
#endif

#if defined(SELECTED)
uniform vec3 selected_colour;
// Some of the point's own colour is left, so that shapes stay visible.
vec3 shown_colour() { return floatBitsToInt(place_and_sign.x) < 0 ? mix(colour_of_point(), selected_colour, 0.75) : colour_of_point(); }
#else
vec3 shown_colour() { return colour_of_point(); }
#endif

#if defined(CLIPS)
uniform vec4 clip_planes[24];  // planes of all clips, relative to the reference; what is on or before all planes of a clip is in it
uniform int clip_ends[4];      // end of each clip's planes
uniform int clip_count;
uniform int clip_outside;      // a bit for each clip that hides what is in it, in place of what is not

bool is_clipped()
{
    vec3 p = position - reference;
    int k = 0;
    for (int c = 0; c < clip_count; ++c) {
        bool inside = true;
        for (; k < clip_ends[c]; ++k) inside = inside && dot(clip_planes[k].xyz, p) + clip_planes[k].w >= 0.0;
        if (inside == ((clip_outside >> c & 1) != 0)) return true;
    }
    return false;
}
#else
bool is_clipped() { return false; }
#endif

// Outside the clip volume in either depth convention.
void draw_nothing()
{
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 1.0;
}

// Alpha of a covered sample: 15 sixteenths, and how wide its splat is on the screen, in half octaves from 1 to 181 pixels: the low four bits,
// 15 for the smallest. composite.frag needs to know: depths below a splat's own size are not relief of the surface. (Found here, once a splat:
// a logarithm for each fragment is a tenth of what splats cost a software renderer.)
float mark_of(float side) { return (255.0 - clamp(floor(2.0 * log2(max(side, 1.0)) + 0.5), 0.0, 15.0)) / 255.0; }

// By how much less it is for a stepped surface (view/depth_steps.h): how deep a step is, in half octaves from 1 to 91 pixels: the high four bits.
float mark_of_steps(float step) { return clamp(floor(2.0 * log2(max(step, 0.1)) + 1.5), 0.0, 14.0) * 16.0 / 255.0; }

uniform float eye_scale;     // eye units per source unit
uniform float least_radius;  // source units,
uniform float least_pixels;  // limited to this diameter on the screen

#if !defined(ADAPTIVE) && !defined(AFFINE) && !defined(DISC) && !defined(FITTED)

uniform float point_size;
uniform float pixels;  // side of a square for a radius of 1 at a depth of 1 (orthographic: anywhere)

void main()
{
    if (is_clipped()) {
        draw_nothing();
        return;
    }
    vec3 eye = to_eye * (position - reference) + translation;
    gl_Position = projection * vec4(eye, 1.0);
    // OpenGL draws nothing of a point whose centre is not in view. NVIDIA's driver draws the part that is.
    if (any(greaterThan(abs(gl_Position.xy), vec2(gl_Position.w)))) {
        draw_nothing();
        return;
    }
    gl_PointSize = max(point_size, min(least_pixels, least_radius * eye_scale * pixels / gl_Position.w));
    splat_colour = vec4(shown_colour(), mark_of(max(point_size, least_pixels)));
}

#else

layout(location = 2) in float radius;  // source units; 0 for a point without one

uniform float radius_scale;
uniform vec2 viewport;    // pixels

// `pixel` is the size of a pixel at the point's depth, source units.
float radius_of_splat(float pixel) { return max(radius * radius_scale, min(least_radius, 0.5 * least_pixels * pixel)); }

#if defined(QUADS)
// This vertex's corner of a box.
vec2 corner(vec2 low, vec2 high) { return vec2((gl_VertexID & 1) == 0 ? low.x : high.x, (gl_VertexID & 2) == 0 ? low.y : high.y); }
#endif

// Two directions that are perpendicular to n and to each other, all of length 1 (Duff et al. 2017).
void tangents(vec3 n, out vec3 t1, out vec3 t2)
{
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    float b = n.x * n.y * a;
    t1 = vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
    t2 = vec3(b, s + n.y * n.y * a, -n.y);
}

#if defined(ADAPTIVE)

uniform float pixels;  // side of a square for a radius of 1 at a depth of 1 (orthographic: anywhere)
#if defined(PARABOLOID)
flat out vec3 depth_radius_side;  // eye units, eye units, pixels
flat out vec2 centre;             // pixels
uniform vec2 focal;               // pixels: window = principal + focal * eye.xy / depth; orthographic: without the division
uniform vec2 principal;
#endif
uniform vec2 guard;    // scales x and y: the clip volume is wider by half the largest point, pixels

void main()
{
    if (is_clipped()) {
        draw_nothing();
        return;
    }
    vec3 eye = to_eye * (position - reference) + translation;
    vec4 place = projection * vec4(eye, 1.0);
    // Equation 7.1 with the side as a diameter. At least one pixel, so that no point vanishes.
    float unit = eye_scale * pixels / place.w;  // pixels of a square's side for a radius of 1
    float side = max(max(radius * radius_scale * unit, min(least_radius * unit, least_pixels)), 1.0);
    splat_colour = vec4(shown_colour(), mark_of(side));
#if defined(PARABOLOID)
    depth_radius_side = vec3(-eye.z, eye_scale * side / unit, side);
#if defined(ORTHOGRAPHIC)
    centre = principal + focal * eye.xy;
#else
    centre = principal + focal * (eye.xy / -eye.z);
#endif
#endif
    if (!(place.w > 0.0)) {
        draw_nothing();
        return;
    }
#if defined(QUADS)
    vec2 middle = place.xy / place.w;
    gl_Position = vec4(corner(middle - side / viewport, middle + side / viewport), place.z / place.w, 1.0);
#else
    gl_Position = vec4(place.xy * guard, place.zw);
    gl_PointSize = side;
#endif
}

#elif defined(FITTED)

// The ellipse is the point's disc as the projection's derivative at its centre shows it, a little wider: its covariance in pixels has 0.5 added
// on the diagonal, so that it covers the centre of a pixel at least, and is not narrower where it is seen edge-on. (The idea of a filter in
// pixels is that of Zwicker et al. 2001.) With p the fragment's pixel relative to the centre,
//   q = dot(conic, (p.x * p.x, p.x * p.y, p.y * p.y)),   inside where q <= 1
//   depth = depth_line.x + dot(p, depth_line.yz), no farther from the first than depth_most, + depth_line.w * q
flat out vec3 conic;
flat out vec2 centre;  // pixels
flat out vec4 depth_line;
flat out float depth_most;
uniform vec2 focal;         // pixels: window = principal + focal * eye.xy / depth; orthographic: without the division
uniform vec2 principal;
uniform vec2 depth_of;      // window depth is x + y / depth; orthographic: x + y * depth
uniform vec2 guard;

const float volume_pixels = 10.0;  // among leaves a splat is not wider, at a crease up to twice as wide
const float volume_factor = 0.15;  // least_volume_factor of view/point_shapes.h
const float volume_growth = 0.6;   // and where finer points are missing it grows this much
const float line_width = 0.25;     // share of a line's length
// How far behind its plane an ellipse's rim lies, in radii: where splats overlap, the one whose centre is nearest is seen.
const float rim_depth = 1.0;

// The octahedral code of view/point_shapes.h, of two parts in this many bits.
vec3 direction_of(uint code, uint bits)
{
    uint most = (1u << bits) - 1u;
    vec2 p = vec2(float(code >> bits & most), float(code & most)) / (0.5 * float(most)) - 1.0;
    vec3 d = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    if (d.z < 0.0) d.xy = (1.0 - abs(d.yx)) * vec2(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0);
    return normalize(d);
}

// Discs that overlap would be a mosaic of colours: near by it is seen, and far away, where it is finer than pixels, it swims when the camera
// turns. In frames of a mean each disc is moved along the view at random, by up to half of `blend` times its rim's depth, which moves its
// borders with its neighbours: in the mean their colours pass into one another.
uniform uint frame;  // frame of a mean; 0: the picture itself
const float blend = 0.33;

float shift_of_border()
{
    uvec3 p = floatBitsToUint(position) * uvec3(0x9e3779b1u, 0x85ebca77u, 0xc2b2ae3du);
    uint h = (p.x ^ p.y ^ p.z) + frame * 0x27d4eb2fu;
    h = (h ^ h >> 16u) * 0x7feb352du;  // a hash of 32 bits (Wellons 2018)
    h = (h ^ h >> 15u) * 0x846ca68bu;
    return blend * (float((h ^ h >> 16u) >> 8u) / 16777216.0 - 0.5);
}

void main()
{
    if (is_clipped()) {
        draw_nothing();
        return;
    }
    vec3 eye = to_eye * (position - reference) + translation;
    vec4 place = projection * vec4(eye, 1.0);
    float depth = -eye.z;
    if (!(place.w > 0.0)) {
        draw_nothing();
        return;
    }
    uint bits = floatBitsToUint(radius);
    uint kind = bits >> 16u & 3u;
    bool stepped = kind == 0u && (bits & 0xffffu) != 0u;
    bool lies = kind == 1u || stepped;
    float volume = kind == 2u ? float(bits & 0xffffu) / 65535.0 : 0.0;
    // The ellipse's radii u and v are in units of the depth (orthographic: of a pixel), so that no square of them leaves what float holds.
#if defined(ORTHOGRAPHIC)
    float unit = abs(1.0 / focal.y);  // eye units
    vec2 zoom = focal * unit;         // pixels
    vec2 slope = vec2(0.0);
    vec3 ray = vec3(0.0, 0.0, -1.0);
#else
    float unit = depth;
    vec2 zoom = focal;
    vec2 slope = eye.xy / depth;
    vec3 ray = vec3(slope, -1.0);
#endif
    float pixel = unit / abs(zoom.y) / eye_scale;  // source units
    float r = uintBitsToFloat(bits & ~0x3ffffu | 0x20000u) * radius_scale;
    if (bits < 0x40000u) r = 0.0;
    float least_r = min(least_radius, 0.5 * least_pixels * pixel);
    // A square for the radius that the point would have on a surface: depths between points of a volume are not relief either.
    float side = mix(3.2, 12.0, volume) * max(r / mix(1.0, volume_factor, volume), least_r) / pixel;
    splat_colour = vec4(shown_colour(), mark_of(side));
    if (stepped) splat_colour.a -= mark_of_steps(1.4142 * exp2(0.5 * float(bits & 15u)) * r / pixel);  // step_of() of view/point_shapes.h
    r = max(r, mix(1.0, volume_growth, volume) * least_r);
    // Rounder surroundings are more likely a volume.
    if (volume > 0.0) r = min(r, 0.5 * volume_pixels * (2.0 - volume) * pixel);
#if !defined(ORTHOGRAPHIC)
    if (!lies) r = min(r, 0.5 * length(ray) * depth / eye_scale);
#endif
    float reach = r * eye_scale / unit;
    vec3 u = vec3(1.0, 0.0, 0.0) * reach, v = vec3(0.0, 1.0, 0.0) * reach;
    if (lies) {
        vec3 t1, t2;
        tangents(stepped ? direction_of(bits >> 4u & 0xfffu, 6u) : direction_of(bits & 0xffffu, 8u), t1, t2);
        u = reach * (to_eye * t1 / eye_scale);
        v = reach * (to_eye * t2 / eye_scale);
    } else if (kind == 3u) {
        u = reach * (to_eye * direction_of(bits & 0xffffu, 8u) / eye_scale);
        vec3 across = cross(ray, u);
        float length_across = length(across);
        if (length_across > 1e-3 * reach) v = across * (line_width * reach / length_across);
    }
#if !defined(ORTHOGRAPHIC)
    // Near the eye a disc would reach behind it, and what the derivative at its centre makes of that over the whole picture: it is cut down to
    // half of its depth towards the eye and away from it, and stays as wide as it is.
    float along_view = length(vec2(u.z, v.z));
    if (along_view > 0.5) {
        vec3 steep = (u.z * u + v.z * v) / along_view;
        v = (u.z * v - v.z * u) / along_view;
        u = steep * (0.5 / along_view);
    }
#endif
    vec2 pu = zoom * (u.xy + slope * u.z);
    vec2 pv = zoom * (v.xy + slope * v.z);
    float area = pu.x * pv.y - pu.y * pv.x;
    float xx = pu.x * pu.x + pv.x * pv.x + 0.5, yy = pu.y * pu.y + pv.y * pv.y + 0.5, xy = pu.x * pu.y + pv.x * pv.y;
    float determinant = area * area + 0.5 * (dot(pu, pu) + dot(pv, pv)) + 0.25;
    conic = vec3(yy, -2.0 * xy, xx) / determinant;
    vec3 n = cross(u, v);
    float towards = dot(n, ray);
    float least = 0.02 * length(n) * length(ray);
    towards = towards < 0.0 ? min(towards, -least) : max(towards, least);
    vec2 tilt = lies && least > 0.0 ? n.xy / (focal * towards) : vec2(0.0);  // slope of depth (orthographic) or of 1 / depth, per pixel
#if defined(ORTHOGRAPHIC)
    depth_line = vec4(depth_of.x + depth_of.y * depth, depth_of.y * tilt, depth_of.y * rim_depth * reach * unit);
    depth_most = abs(depth_of.y) * reach * unit;
    centre = principal + focal * eye.xy;
#else
    depth_line = vec4(depth_of.x + depth_of.y / depth, depth_of.y * tilt / depth, -depth_of.y * rim_depth * reach / depth);
    depth_most = abs(depth_of.y) * reach / depth;
    centre = principal + focal * slope;
#endif
    if (frame > 0u && lies) depth_line.x += depth_line.w * shift_of_border();
    vec2 extent = sqrt(vec2(xx, yy));
#if defined(QUADS)
    vec2 middle = place.xy / place.w;
    gl_Position = vec4(corner(middle - 2.0 * extent / viewport, middle + 2.0 * extent / viewport), place.z / place.w, 1.0);
#else
    gl_Position = vec4(place.xy * guard, place.zw);
    gl_PointSize = 2.0 * max(extent.x, extent.y);
#endif
}

#else

// A fragment's place in its disc is a linear function of its pixel, or a quotient of linear functions. With p the fragment's pixel relative to a
// base pixel (`base` is a pixel's centre, exact; `rest` what is added to it):
//   place = (origin + p.x * along_x + p.y * along_y) / (divisor.x + dot(p, divisor.yz)),   inside where |place| <= 1
//   depth = depth_line.x + dot(p, depth_line.yz)
// For AFFINE the divisor is 1, and depth_line gives the distance from the eye along the view, from which the depth follows.
flat out vec4 base_and_rest;
flat out vec4 along;  // along_x, along_y
flat out vec2 origin;
flat out vec3 divisor;
flat out vec3 depth_line;

layout(location = 3) in vec3 normal;  // source axes; 0 for a point without one

uniform rvec2 focal;      // pixels: window = principal + focal * eye.xy / depth; orthographic: without the division
uniform rvec2 principal;
uniform vec2 depth_of;    // window depth is x + y / depth; orthographic: x + y * depth

// Draws the part of a box (normalised device coordinates) that lies in the viewport, with a margin of one pixel. The centre of that part
// lies in the clip volume, wherever the splat's own centre is.
void draw_box(vec2 low, vec2 high)
{
    vec2 pixel = 2.0 / viewport;
    low = max(low - pixel, vec2(-1.0));
    high = min(high + pixel, vec2(1.0));
    if (!(low.x < high.x && low.y < high.y)) {
        draw_nothing();
        return;
    }
#if defined(QUADS)
    gl_Position = vec4(corner(low, high), 0.5, 1.0);
#else
    gl_Position = vec4(0.5 * (low + high), 0.5, 1.0);
    vec2 size = (high - low) / pixel;
    gl_PointSize = max(size.x, size.y);
#endif
}

void set_base(rvec2 window)
{
    rvec2 centre = floor(window) + real(0.5);
    base_and_rest = vec4(vec2(centre), vec2(window - centre));
}

#if defined(AFFINE)

uniform mat3 normal_to_eye;

// Equations 7.2 to 7.4: rays are taken as parallel to the view around the splat's centre.
void main()
{
    if (is_clipped()) {
        draw_nothing();
        return;
    }
    splat_colour = vec4(shown_colour(), 1.0);
    vec3 eye = to_eye * (position - reference) + translation;
    float depth = -eye.z;
    float r = radius_of_splat(abs(depth / focal.y) / eye_scale) * eye_scale;
    vec3 n = normal == vec3(0.0) ? vec3(0.0, 0.0, 1.0) : normalize(normal_to_eye * normal);
    if (!(depth > 0.0 && r > 0.0 && n.z != 0.0)) {
        draw_nothing();
        return;
    }
    vec2 pixel = depth / focal;  // eye units
    vec2 slope = -n.xy / n.z;    // equation 7.2
    vec3 t1, t2;
    tangents(n, t1, t2);
    vec3 x = vec3(pixel.x, 0.0, slope.x * pixel.x) / r;
    vec3 y = vec3(0.0, pixel.y, slope.y * pixel.y) / r;
    along = vec4(dot(x, t1), dot(x, t2), dot(y, t1), dot(y, t2));
    origin = vec2(0.0);
    divisor = vec3(1.0, 0.0, 0.0);
    depth_line = vec3(depth, -slope * pixel);
    set_base(principal + focal * eye.xy / depth);
    vec4 place = projection * vec4(eye, 1.0);
    vec2 centre = place.xy / place.w;
    vec2 extent = r * sqrt(max(1.0 - n.xy * n.xy, 0.0)) / pixel * 2.0 / viewport * 1.001;
    draw_box(centre - extent, centre + extent);
}

#else

uniform rvec3 from_eye;     // from the eye to the reference
uniform rvec3 pixel_x;      // one pixel to the right at a depth of 1 (orthographic: anywhere)
uniform rvec3 pixel_y;      // one pixel up
uniform rvec3 centre_ray;   // through the centre of the pixel at `centre_pixel`, to a depth of 1 (orthographic: every ray)
uniform vec2 centre_pixel;
uniform vec4 pixel_bounds;  // the centres of the viewport's first and last pixel
uniform float near;         // depth of the near plane; perspective only
// All vectors are in the cloud's own axes: there the disc is round and its normal the uploaded one, whatever the modelview is.

// Draws a box that encloses the projected disc. `centre`, and the ends of two perpendicular radii `u` and `v` relative to it, are in clip space.
void draw_disc(vec4 centre, vec4 u, vec4 v)
{
#if defined(ORTHOGRAPHIC)
    vec2 extent = sqrt(u.xy * u.xy + v.xy * v.xy) * 1.001;
    draw_box(centre.xy - extent, centre.xy + extent);
#else
    float along_view = length(vec2(u.w, v.w));
    float nearest = centre.w - along_view;
    float farthest = centre.w + along_view;
    if (!(farthest > near)) {
        draw_nothing();
        return;
    }
    if (nearest > near && nearest > 1e-3 * centre.w) {
        // Box of the ellipse, relative to the projected centre: where the lines x = const touch the disc.
        vec2 middle = centre.xy / centre.w;
        vec2 du = u.xy - middle * u.w;
        vec2 dv = v.xy - middle * v.w;
        float ww = nearest * farthest;
        vec2 xw = du * u.w + dv * v.w;
        vec2 xx = du * du + dv * dv;
        vec2 extent = sqrt(xw * xw + ww * xx) / ww * 1.01;
        vec2 shifted = middle - xw / ww;
        draw_box(shifted - extent, shifted + extent);
        return;
    }
    // The disc crosses the near plane, or is close to the eye: the box encloses the part beyond the near plane of the square around
    // the disc, whose sides run along and across the view.
    vec4 along_side = (u.w * u + v.w * v) / along_view;
    vec4 across_side = (u.w * v - v.w * u) / along_view;
    float first = max((near - centre.w) / along_view, -1.0);
    float first_w = max(centre.w + first * along_view, near);
    if (!(first_w > 1e-4 * (abs(centre.w) + along_view))) {
        draw_box(vec2(-1.0), vec2(1.0));  // too near for float to resolve
        return;
    }
    vec2 low = vec2(1e30);
    vec2 high = vec2(-1e30);
    for (int i = 0; i < 4; ++i) {
        float side = (i & 1) == 0 ? -1.0 : 1.0;
        bool at_first = (i & 2) == 0;
        vec2 place = (centre.xy + (at_first ? first : 1.0) * along_side.xy + side * across_side.xy) / (at_first ? first_w : farthest);
        low = min(low, place);
        high = max(high, place);
    }
    vec2 spare = 0.01 * (high - low);
    draw_box(low - spare, high + spare);
#endif
}

// Equations 7.5 to 7.8. With v from the eye to the splat's centre, n its normal, h = v.n, and D the ray of a pixel, a depth of 1 long, the
// hit is t D with t = h / D.n, and relative to the centre it is (D h - v D.n) / D.n, whose numerator is linear in the pixel. The base
// pixel keeps it exact:
//   far away (beyond four radii) the base is the projected centre. There the numerator is 0, so that everything is relative to the
//     centre, and no two large numbers are subtracted;
//   nearer, where v is not large compared with the radius and the centre may lie next to or behind the eye, the base is the pixel
//     nearest to the plane's horizon, where D.n is smallest.
void main()
{
    if (is_clipped()) {
        draw_nothing();
        return;
    }
    splat_colour = vec4(shown_colour(), 1.0);
    rvec3 local = rvec3(position) - rvec3(reference);
#if defined(ORTHOGRAPHIC)
    rvec3 view = centre_ray;
    rvec3 eye = to_eye * local + translation;
#else
    rvec3 view = local + from_eye;
    rvec3 eye = to_eye * view;
#endif
    real depth = -eye.z;
#if defined(ORTHOGRAPHIC)
    float r = radius_of_splat(abs(float(1.0 / focal.y)) / eye_scale);
#else
    float r = radius_of_splat(abs(float(depth / focal.y)) / eye_scale);
#endif
    vec3 n = normal == vec3(0.0) ? normalize(vec3(view)) : normal;
    vec3 t1, t2;
    tangents(n, t1, t2);
    rvec3 rn = rvec3(n);
    rvec3 r1 = rvec3(t1);
    rvec3 r2 = rvec3(t2);
    real h = dot(view, rn);
    if (!(r > 0.0) || h == real(0.0)) {  // edge-on
        draw_nothing();
        return;
    }
    rvec2 steps = rvec2(dot(pixel_x, rn), dot(pixel_y, rn));
    rvec2 view_t = rvec2(dot(view, r1), dot(view, r2));
    rvec2 x_t = rvec2(dot(pixel_x, r1), dot(pixel_x, r2));
    rvec2 y_t = rvec2(dot(pixel_y, r1), dot(pixel_y, r2));
    real per_radius = real(1.0) / real(r);
#if !defined(ORTHOGRAPHIC)
    if (depth <= real(4.0 * r * eye_scale)) {
        rvec2 centre = rvec2(centre_pixel);
        real m = dot(centre_ray, rn);
        rvec2 to_horizon = -m * steps / max(dot(steps, steps), real(1e-30));
        set_base(rvec2(clamp(floor(vec2(centre + to_horizon)) + 0.5, pixel_bounds.xy, pixel_bounds.zw)));
        rvec2 moved = rvec2(base_and_rest.xy) - centre;
        m += dot(moved, steps);
        rvec3 ray = centre_ray + moved.x * pixel_x + moved.y * pixel_y;
        origin = vec2((rvec2(dot(ray, r1), dot(ray, r2)) * h - view_t * m) * per_radius);
        along = vec4((x_t * h - view_t * steps.x) * per_radius, (y_t * h - view_t * steps.y) * per_radius);
        divisor = vec3(m, steps);
        depth_line = vec3(real(depth_of.x) + real(depth_of.y) * m / h, real(depth_of.y) / h * steps);
    } else
#endif
    {
        rvec2 slope = steps / h;
        origin = vec2(0.0);
#if defined(ORTHOGRAPHIC)
        set_base(principal + focal * eye.xy);
        real scale = per_radius;
        divisor = vec3(1.0, 0.0, 0.0);
        depth_line = vec3(real(depth_of.x) + real(depth_of.y) * depth, -real(depth_of.y) * slope);
#else
        set_base(principal + focal * eye.xy / depth);
        real scale = per_radius * depth;
        divisor = vec3(1.0, depth * slope);
        depth_line = vec3(real(depth_of.x) + real(depth_of.y) / depth, real(depth_of.y) * slope);
#endif
        along = vec4((x_t - view_t * slope.x) * scale, (y_t - view_t * slope.y) * scale);
    }
    mat3 turn = mat3(to_eye);
    draw_disc(projection * vec4(vec3(eye), 1.0), projection * vec4(turn * (r * t1), 0.0), projection * vec4(turn * (r * t2), 0.0));
}

#endif
#endif
#endif
