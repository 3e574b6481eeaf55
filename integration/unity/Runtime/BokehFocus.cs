// SPDX-License-Identifier: MIT
// Sets the focus distance of BokehRendererFeature. Add this component to the camera. The distance comes from `target`
// if it is set, else from the autofocus on `points` if there are any, else it is `distance`.

using UnityEngine;

namespace PolygonalBokeh
{
    [RequireComponent(typeof(Camera))]
    public sealed class BokehFocus : MonoBehaviour
    {
        [Tooltip("The object to keep in focus. If there is none, the points or the distance below set the focus.")]
        public Transform target;

        [Tooltip("Distance to the plane in focus, in metres along the view axis.")]
        public float distance = 5.0f;

        [Tooltip("Autofocus focuses on the nearest collider under these points of the view. (0, 0) is the lower left "
            + "corner, and (1, 1) is the upper right corner.")]
        public Vector2[] points = new Vector2[0];

        [Tooltip("Time in seconds in which autofocus covers 63 % of the way to a new distance.")]
        public float pullTime = 0.2f;

        // Returns the depth of a point of the world along the view axis, metres. This is not the length of the ray.
        public static float PlanarDepth(Camera camera, Vector3 position)
        {
            return Vector3.Dot(position - camera.transform.position, camera.transform.forward);
        }

        // Focuses on the object at a pixel, and clears `target`. Returns false if no object with a collider is there.
        //
        // pixel  in the same coordinates as Input.mousePosition; (0, 0) is the lower left
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

        // Returns the depth of the nearest collider under `points`, metres, or infinity if there is none.
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

        // Moves the focus smoothly towards a depth. Interpolates 1 / distance instead of the distance (docs/lens.md).
        //
        // nearest  depth along the view axis, metres
        // seconds  time since the last call
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
