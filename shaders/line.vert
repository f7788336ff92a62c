#version 330 core
// A corner of the quad around a segment of a line; places are computed by gl/line_pass.cpp.
layout(location = 0) in vec3 place;    // normalised device coordinates
layout(location = 1) in vec4 segment;  // along and across it, its length and half its width, pixels
layout(location = 2) in vec4 colour;
layout(location = 3) in float hidden;  // factor on the opacity of hidden parts

uniform bool is_hidden;

out vec2 from_start;
flat out vec2 length_and_half;
flat out vec4 line_colour;

void main()
{
    gl_Position = vec4(place, 1.0);
    from_start = segment.xy;
    length_and_half = segment.zw;
    line_colour = vec4(colour.rgb, colour.a * (is_hidden ? hidden : 1.0));
}
