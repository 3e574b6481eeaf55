// SPDX-License-Identifier: MIT
// On a camera: the focus distance of BokehRendererFeature, from an object or from a picked pixel.

using UnityEngine;

namespace PolygonalBokeh
{
    [RequireComponent(typeof(Camera))]
    public sealed class BokehFocus : MonoBehaviour
    {
        [Tooltip("Stays in focus; none: the distance below is used")]
        public Transform target;

        [Tooltip("Metres along the view axis")]
        public float distance = 5.0f;

        [Tooltip("Autofocus: points of the view, (0, 0) lower left to (1, 1); the nearest of what lies under them wins")]
        public Vector2[] points = new Vector2[0];

        [Tooltip("Time constant of the autofocus, seconds")]
        public float pullTime = 0.2f;

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

        // Under points of the view; infinite where nothing with a collider is
        public float NearestDepth(Camera camera)
        {
            float nearest = float.PositiveInfinity;
            foreach (Vector2 point in points)
            {
                if (Physics.Raycast(camera.ViewportPointToRay(point), out RaycastHit hit))
                {
                    nearest = Mathf.Min(nearest, PlanarDepth(camera, hit.point));
                }
            }
            return nearest;
        }

        // 1 / distance changes evenly, not the distance: docs/lens.md
        public void Pull(float nearest, float seconds)
        {
            float k = 1.0f - Mathf.Exp(-seconds / pullTime);
            distance = 1.0f / ((1.0f - k) / distance + k / nearest);
        }

        void LateUpdate()
        {
            Camera camera = GetComponent<Camera>();
            if (target != null)
            {
                distance = PlanarDepth(camera, target.position);
            }
            else if (points.Length > 0)
            {
                Pull(NearestDepth(camera), Time.deltaTime);
            }
        }
    }
}
