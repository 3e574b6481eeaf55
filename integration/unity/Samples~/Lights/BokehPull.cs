// SPDX-License-Identifier: MIT

using PolygonalBokeh;
using UnityEngine;

// Moves the focus from 2 m to 20 m and back in 8 seconds. Put this component on a camera.
[RequireComponent(typeof(BokehFocus))]
public sealed class BokehPull : MonoBehaviour
{
    void Update()
    {
        // interpolate 1 / distance instead of the distance: docs/lens.md
        float blend = Mathf.PingPong(0.25f * Time.time, 1.0f);
        GetComponent<BokehFocus>().distance = 1.0f / Mathf.Lerp(0.5f, 0.05f, blend);
    }
}
