#version 330 core
// A point becomes a square splat. Permutations: VERTEX_COLOUR, HEIGHT_COLOUR, or neither for one colour.
//
// `reference` is a point of the chunk near the eye, in the chunk's coordinates, exact in float; `translation` is where
// it lies in eye space, computed in double. Near the reference the subtraction is exact, so the rounding error of
// the result shrinks with the distance from the eye, wherever on earth and however large the chunk is.

layout(location = 0) in vec3 position;

uniform vec3 reference;
uniform mat3 to_eye;
uniform vec3 translation;
uniform mat4 projection;
uniform float point_size;

flat out vec3 splat_colour;

#if defined(VERTEX_COLOUR)
layout(location = 1) in vec4 colour;
vec3 colour_of_point() { return colour.rgb; }
#elif defined(HEIGHT_COLOUR)
uniform vec2 height;  // position.z * height.x + height.y is 0 at the cloud's bottom, 1 at its top

// A ramp of even lightness steps (dark blue, teal, green, yellow), so that equal steps of height look equal.
vec3 colour_of_point()
{
    float t = clamp(position.z * height.x + height.y, 0.0, 1.0);
    const vec3 c0 = vec3(0.267, 0.005, 0.329), c1 = vec3(0.230, 0.322, 0.546), c2 = vec3(0.128, 0.567, 0.551),
               c3 = vec3(0.369, 0.789, 0.383), c4 = vec3(0.993, 0.906, 0.144);
    float s = t * 4.0;
    if (s < 1.0) return mix(c0, c1, s);
    if (s < 2.0) return mix(c1, c2, s - 1.0);
    if (s < 3.0) return mix(c2, c3, s - 2.0);
    return mix(c3, c4, s - 3.0);
}
#else
uniform vec3 uniform_colour;
vec3 colour_of_point() { return uniform_colour; }
#endif

void main()
{
    vec3 eye = to_eye * (position - reference) + translation;
    gl_Position = projection * vec4(eye, 1.0);
    gl_PointSize = point_size;
    splat_colour = colour_of_point();
}
