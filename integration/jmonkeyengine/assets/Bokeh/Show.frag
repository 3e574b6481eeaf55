uniform sampler2D m_Texture;
in vec2 BokehUV;
out vec4 color;

// Writes 1 to alpha. The alpha of the result is the CoC, and later filters might use it to blend.
void main()
{
    color = vec4(textureLod(m_Texture, BokehUV, 0.0).rgb, 1.0);
}
