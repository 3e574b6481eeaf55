// SPDX-License-Identifier: MIT
// On a camera: the focus distance of BokehRendererFeature, from an object or from a picked pixel.

using UnityEngine;

[RequireComponent(typeof(Camera))]
public sealed class BokehFocus : MonoBehaviour
{
    [Tooltip("Stays in focus; none: the distance below is used")]
    public Transform target;

    [Tooltip("Metres along the view axis")]
    public float distance = 5.0f;

    // Depth along the view axis, not the length of the ray
    public static float PlanarDepth(Camera camera, Vector3 position)
    {
        return Vector3.Dot(position - camera.transform.position, camera.transform.forward);
    }

    // pixel: as Input.mousePosition gives it. False where nothing with a collider is there.
    public bool FocusOnPixel(Vector2 pixel)
    {
        Camera camera = GetComponent<Camera>();
        if (!Physics.Raycast(camera.ScreenPointToRay(pixel), out RaycastHit hit))
        {
            return false;
        }
        target = null;
        distance = PlanarDepth(camera, hit.point);
        return true;
    }

    void LateUpdate()
    {
        if (target != null)
        {
            distance = PlanarDepth(GetComponent<Camera>(), target.position);
        }
    }
}
