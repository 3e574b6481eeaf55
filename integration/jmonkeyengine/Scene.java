import com.jme3.asset.AssetManager;
import com.jme3.light.AmbientLight;
import com.jme3.light.DirectionalLight;
import com.jme3.material.Material;
import com.jme3.math.ColorRGBA;
import com.jme3.math.FastMath;
import com.jme3.math.Quaternion;
import com.jme3.math.Vector2f;
import com.jme3.math.Vector3f;
import com.jme3.renderer.Camera;
import com.jme3.scene.Geometry;
import com.jme3.scene.Mesh;
import com.jme3.scene.Node;
import com.jme3.scene.shape.Box;
import com.jme3.scene.shape.Cylinder;
import com.jme3.scene.shape.Quad;
import com.jme3.scene.shape.Sphere;
import com.jme3.texture.Image;
import com.jme3.texture.Texture;
import com.jme3.texture.Texture2D;
import com.jme3.texture.image.ColorSpace;
import com.jme3.util.BufferUtils;
import java.nio.ByteBuffer;

/**
 * The sample's scene: a tower in focus on a checkered ground, with a ball and a lamp in front of it, and lamps behind
 * it. Lengths are in metres.
 */
class Scene {
    static final float FIELD_OF_VIEW = 27f; // degrees, vertical: that of a 50 mm lens
    static final Vector2f BALL = new Vector2f(0.3f, 0.51f);
    static final Vector2f TOWER = new Vector2f(0.47f, 0.42f);

    private final AssetManager assets;
    private final Node root;
    private final Texture checker = checker();

    Scene(AssetManager assets, Node root) {
        this.assets = assets;
        this.root = root;
    }

    void build() {
        root.addLight(new DirectionalLight(new Vector3f(0.5f, -0.7f, -0.5f), new ColorRGBA(1.6f, 1.5f, 1.4f, 1f)));
        root.addLight(new AmbientLight(new ColorRGBA(0.25f, 0.27f, 0.32f, 1f)));
        Quaternion lying = new Quaternion().fromAngles(-FastMath.HALF_PI, 0f, 0f);
        Mesh ground = new Quad(40f, 40f);
        ground.scaleTextureCoordinates(new Vector2f(40f, 40f));
        lit(ground, new ColorRGBA(0.34f, 0.3f, 0.27f, 1f), -20f, 0f, 4f).setLocalRotation(lying);
        lit(new Cylinder(2, 32, 0.34f, 0.5f, true), new ColorRGBA(0.7f, 0.2f, 0.1f, 1f), -0.1f, 0.25f, -5f)
                .setLocalRotation(lying);
        lit(new Box(0.26f, 0.25f, 0.26f), new ColorRGBA(0.85f, 0.6f, 0.2f, 1f), -0.1f, 0.75f, -5f)
                .setLocalRotation(new Quaternion().fromAngles(0f, 0.5f, 0f));
        lit(new Sphere(32, 48, 0.24f), new ColorRGBA(0.2f, 0.5f, 0.45f, 1f), -0.1f, 1.24f, -5f)
                .setLocalRotation(lying);
        lit(new Sphere(32, 48, 0.12f), new ColorRGBA(0.7f, 0.6f, 0.5f, 1f), -0.36f, 1.3f, -2.5f)
                .setLocalRotation(lying);
        lamp(0.35f, 1.5f, -2.2f, 0.012f, new ColorRGBA(9f, 16f, 30f, 1f));
        ColorRGBA[] colors = {
            new ColorRGBA(1f, 0.5f, 0.2f, 1f),
            new ColorRGBA(0.3f, 0.55f, 1f, 1f),
            new ColorRGBA(1f, 0.15f, 0.1f, 1f),
            new ColorRGBA(0.2f, 1f, 0.45f, 1f),
        };
        for (int index = 0; index < 18; index++) {
            // the golden angle spreads the lamps evenly, and they are the same each time
            float depth = 11f + index % 5;
            float angle = 2.39996f * index;
            float reach = FastMath.sqrt((index + 1f) / 18f);
            float half = depth * FastMath.tan(0.5f * FIELD_OF_VIEW * FastMath.DEG_TO_RAD);
            float x = 1.3f * half * reach * FastMath.cos(angle);
            float y = 1.6f + 0.55f * half * (1f + reach * FastMath.sin(angle)) - 0.09f * depth;
            lamp(x, y, -depth, 0.05f, colors[index % 4].mult(20f + 10f * (index % 3)));
        }
    }

    static void aim(Camera camera) {
        float aspect = (float) camera.getWidth() / camera.getHeight();
        camera.setFrustumPerspective(FIELD_OF_VIEW, aspect, 0.1f, 60f);
        camera.setLocation(new Vector3f(0f, 1.5f, 0f));
        camera.lookAt(new Vector3f(0f, 1.1f, -5f), Vector3f.UNIT_Y);
    }

    private Geometry lit(Mesh mesh, ColorRGBA color, float x, float y, float z) {
        Material material = new Material(assets, "Common/MatDefs/Light/Lighting.j3md");
        material.setBoolean("UseMaterialColors", true);
        material.setColor("Diffuse", color);
        material.setColor("Ambient", color);
        material.setTexture("DiffuseMap", checker);
        return add(mesh, material, x, y, z);
    }

    /** Adds a lamp. Its colour is above 1, and the float target keeps such values. */
    private void lamp(float x, float y, float z, float radius, ColorRGBA color) {
        Material material = new Material(assets, "Common/MatDefs/Misc/Unshaded.j3md");
        material.setColor("Color", color);
        add(new Sphere(16, 24, radius), material, x, y, z);
    }

    private Geometry add(Mesh mesh, Material material, float x, float y, float z) {
        Geometry geometry = new Geometry("thing", mesh);
        geometry.setMaterial(material);
        geometry.setLocalTranslation(x, y, z);
        root.attachChild(geometry);
        return geometry;
    }

    private static Texture checker() {
        int side = 64;
        ByteBuffer texels = BufferUtils.createByteBuffer(4 * side * side);
        for (int texel = 0; texel < side * side; texel++) {
            byte grey = (byte) ((texel / 16 + texel / side / 16) % 2 == 0 ? 255 : 150);
            texels.put(grey).put(grey).put(grey).put((byte) 255);
        }
        texels.flip();
        Texture2D checker = new Texture2D(new Image(Image.Format.RGBA8, side, side, texels, ColorSpace.sRGB));
        checker.setWrap(Texture.WrapMode.Repeat);
        checker.setMinFilter(Texture.MinFilter.Trilinear);
        checker.setAnisotropicFilter(8);
        return checker;
    }
}
