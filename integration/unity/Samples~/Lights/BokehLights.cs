// SPDX-License-Identifier: MIT
// Fills the scene with lights, 2 m to 20 m in front of the camera, through which the focus moves. Put this component on
// the main camera of an empty scene and press Play.

using PolygonalBokeh;
using UnityEngine;

[RequireComponent(typeof(BokehPull))]
public sealed class BokehLights : MonoBehaviour
{
    const int Rows = 7;
    const int Columns = 9;

    void Start()
    {
        for (int i = 0; i < Rows * Columns; i++)
        {
            int column = i % Columns;
            float depth = 2.0f + 18.0f * column / (Columns - 1);
            GameObject light = GameObject.CreatePrimitive(PrimitiveType.Sphere);
            float right = depth * 0.1f * (column - Columns / 2);
            float up = depth * 0.15f * (i / Columns - Rows / 2);
            light.transform.localScale = 0.01f * depth * Vector3.one;
            light.transform.position = transform.position + right * transform.right + up * transform.up
                + depth * transform.forward;
            Material material = light.GetComponent<Renderer>().material;
            material.EnableKeyword("_EMISSION");
            material.SetColor("_EmissionColor", 60.0f * Color.HSVToRGB((float)column / Columns, 0.6f, 1.0f));
        }
    }
}
