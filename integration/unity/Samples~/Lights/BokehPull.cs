// SPDX-License-Identifier: MIT

using PolygonalBokeh;
using UnityEngine;

// On a camera: the focus goes from 2 m to 20 m and back in 8 seconds.
[RequireComponent(typeof(BokehFocus))]
public sealed class BokehPull : MonoBehaviour
{
    void Update()
    {
        // 1 / distance changes evenly, not the distance: docs/lens.md
        float share = Mathf.PingPong(0.25f * Time.time, 1.0f);
        GetComponent<BokehFocus>().distance = 1.0f / Mathf.Lerp(0.5f, 0.05f, share);
    }
}
