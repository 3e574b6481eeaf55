in vec4 inPosition;
out vec2 BokehUV;

// The corners of a filter's quad have coordinates of 0 and 1. v = 0 is the first row in memory.
void main()
{
    BokehUV = inPosition.xy;
    gl_Position = vec4(inPosition.xy * 2.0 - 1.0, 0.0, 1.0);
}
