uniform sampler2D m_Texture;
in vec2 BokehUV;
out vec4 color;

// alpha was the CoC; what comes next may blend by it
void main()
{
    color = vec4(textureLod(m_Texture, BokehUV, 0.0).rgb, 1.0);
}
