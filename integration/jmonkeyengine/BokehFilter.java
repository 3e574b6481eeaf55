import com.jme3.asset.AssetManager;
import com.jme3.collision.CollisionResults;
import com.jme3.material.Material;
import com.jme3.math.Ray;
import com.jme3.math.Vector2f;
import com.jme3.math.Vector3f;
import com.jme3.post.Filter;
import com.jme3.renderer.Camera;
import com.jme3.renderer.RenderManager;
import com.jme3.renderer.Renderer;
import com.jme3.renderer.ViewPort;
import com.jme3.scene.Spatial;
import com.jme3.texture.FrameBuffer;
import com.jme3.texture.FrameBuffer.FrameBufferTarget;
import com.jme3.texture.Image.Format;
import com.jme3.texture.Texture;
import com.jme3.texture.Texture2D;
import java.util.ArrayList;
import java.util.LinkedHashMap;
import java.util.Map;

/** Depth of field with polygonal bokeh, for a FilterPostProcessor. */
public class BokehFilter extends Filter {
    /**
     * A pass.
     *
     * reads   textures for the slots ("-": not this one)
     * writes  its targets
     * scale   their size: 1 / scale of the image, rounded up
     * sets    parameters of its own
     */
    public record Step(BokehPass pass, String reads, String writes, int scale, Map<String, Float> sets) {}

    public static final Step[] HEXAGON = {
        new Step(BokehPass.SIGNED_COC_MAP, "scene", "coc", 1, Map.of()),
        new Step(BokehPass.LAYER_TILES, "coc", "tiles", 8, Map.of()),
        new Step(BokehPass.LAYER_REACH, "tiles", "rows", 8, Map.of("Axis", 0f)),
        new Step(BokehPass.LAYER_REACH, "rows", "reach", 8, Map.of("Axis", 1f)),
        new Step(BokehPass.LAYER_SPLIT, "coc reach", "near far sums leftovers", 2, Map.of()),
        new Step(BokehPass.LAYER_KERNELS, "sums leftovers", "tileLeftovers tileSums", 8, Map.of()),
        new Step(BokehPass.LAYER_SPREAD, "tileLeftovers tileSums reach", "rowLeftovers rowSums", 8, Map.of()),
        new Step(BokehPass.LAYER_SIZES, "rowLeftovers rowSums reach", "reaches sizes", 8, Map.of()),
        new Step(BokehPass.LAYER_HOLES, "coc reach", "middleHoles farHoles shares", 4, Map.of()),
        new Step(BokehPass.LAYER_FILL, "middleHoles farHoles shares reach", "middle back", 4, Map.of("Sides", 6f)),
        new Step(BokehPass.HEXAGON_LAYER_FIRST, "near sizes", "near2 near3", 2, Map.of("Layer", 0f)),
        new Step(BokehPass.HEXAGON_LAYER_SECOND, "near2 near3 - - sizes", "nearBlurred", 2, Map.of("Layer", 0f)),
        new Step(BokehPass.HEXAGON_LAYER_FIRST, "far sizes", "far2 far3", 2, Map.of("Layer", 1f)),
        new Step(BokehPass.HEXAGON_LAYER_SECOND, "far2 far3 - - sizes", "farBlurred", 2, Map.of("Layer", 1f)),
        new Step(BokehPass.LAYERED, "coc reaches nearBlurred farBlurred middle back", "result", 1, Map.of("Sides", 6f)),
    };

    private static final String[] SLOTS = {"Texture", "TextureB", "TextureC", "TextureD", "TextureE", "TextureF"};
    private static final float SENSOR_HEIGHT = 0.024f;

    private final Step[] table;
    private final Map<String, Texture2D> textures = new LinkedHashMap<>();
    private Camera camera;

    private float fStop = 2.8f;
    private float focusDistance = 5f;

    private Spatial focusScene;
    private Vector2f[] focusPoints = {};
    private float focusTime = 0.2f;
    private boolean cut = true;

    public BokehFilter() {
        this(HEXAGON);
    }

    public BokehFilter(Step[] table) {
        super("Bokeh");
        this.table = table;
    }

    /** The f-stop; smaller than any real one for more blur: docs/lens.md. */
    public void setFStop(float fStop) {
        this.fStop = fStop;
    }

    /** A depth along the view axis, metres. Ends the autofocus. */
    public void setFocusDistance(float metres) {
        focusDistance = metres;
        focusPoints = new Vector2f[0];
    }

    public float getFocusDistance() {
        return focusDistance;
    }

    /**
     * Autofocus: on what lies under points of the screen, the nearest of them.
     *
     * @param scene what rays are cast into
     * @param seconds time constant of the pull: 0.1 quick, 0.3 calm
     * @param points (0, 0) lower left to (1, 1)
     */
    public void setAutofocus(Spatial scene, float seconds, Vector2f... points) {
        focusScene = scene;
        focusTime = seconds;
        focusPoints = points;
    }

    /** After a cut of the camera: the next frame is in focus at once. */
    public void cut() {
        cut = true;
    }

    /** Depth along the view axis under a point of the screen, metres; infinite where there is nothing. */
    public float depthUnder(Vector2f point) {
        Vector2f pixel = new Vector2f(point.x * camera.getWidth(), point.y * camera.getHeight());
        Vector3f start = camera.getWorldCoordinates(pixel, 0f);
        Vector3f direction = camera.getWorldCoordinates(pixel, 1f).subtractLocal(start).normalizeLocal();
        CollisionResults hits = new CollisionResults();
        focusScene.collideWith(new Ray(start, direction), hits);
        if (hits.size() == 0) {
            return Float.POSITIVE_INFINITY;
        }
        Vector3f hit = hits.getClosestCollision().getContactPoint();
        return hit.subtract(camera.getLocation()).dot(camera.getDirection());
    }

    /** 1 / distance goes the way: by it all things sharpen and blur evenly. 1 / infinity is 0. */
    private void pullFocus(float seconds) {
        float nearest = 0f;
        for (Vector2f point : focusPoints) {
            nearest = Math.max(nearest, 1f / depthUnder(point));
        }
        float k = cut ? 1f : 1f - (float) Math.exp(-seconds / focusTime);
        float now = 1f / focusDistance;
        focusDistance = 1f / (now + k * (nearest - now));
        cut = false;
    }

    @Override
    protected void preFrame(float seconds) {
        if (focusPoints.length > 0) {
            pullFocus(seconds);
        }
        // the lens of the blur is the lens of the camera: docs/lens.md
        float focalLength = 0.5f * SENSOR_HEIGHT * Math.abs(camera.getProjectionMatrix().m11);
        for (Pass pass : postRenderPasses) {
            Material material = pass.getPassMaterial();
            material.setFloat("FocalLength", focalLength);
            material.setFloat("ApertureDiameter", focalLength / fStop);
            material.setFloat("FocusDistance", focusDistance);
            material.setFloat("Near", camera.getFrustumNear());
            material.setFloat("Far", camera.getFrustumFar());
        }
    }

    @Override
    protected void initFilter(AssetManager assets, RenderManager manager, ViewPort view, int width, int height) {
        if (processor.getNumSamples() > 1) {
            throw new IllegalStateException("BokehFilter reads one sample a pixel: FilterPostProcessor.setNumSamples(1)");
        }
        camera = view.getCamera();
        textures.clear();
        postRenderPasses = new ArrayList<>();
        Step depth = new Step(BokehPass.LINEAR_DEPTH, "", "metres", 1, Map.of());
        postRenderPasses.add(new StepPass(assets, depth, Format.R32F, width, height));
        for (Step step : table) {
            postRenderPasses.add(new StepPass(assets, step, Format.RGBA16F, width, height));
        }
        material = new Material(assets, "Bokeh/Show.j3md");
    }

    /** The texture that a pass wrote, by its name in the table. */
    public Texture2D getTexture(String name) {
        return textures.get(name);
    }

    /** Draws onto all targets of a step. */
    private class StepPass extends Pass {
        private final Step step;
        private final ArrayList<Texture2D> targets = new ArrayList<>();

        StepPass(AssetManager assets, Step step, Format format, int width, int height) {
            this.step = step;
            passMaterial = new Material(assets, "Bokeh/Bokeh.j3md");
            passMaterial.setInt("Pass", step.pass.number());
            passMaterial.setFloat("AspectRatio", (float) width / height);
            passMaterial.setFloat("ImageWidth", width);
            passMaterial.setFloat("ImageHeight", height);
            step.sets.forEach(passMaterial::setFloat);
            String[] reads = step.reads.split(" ");
            for (int slot = 0; slot < reads.length; slot++) {
                if (textures.containsKey(reads[slot])) {
                    passMaterial.setTexture(SLOTS[slot], textures.get(reads[slot]));
                }
            }
            if (!requiresDepthAsTexture()) {
                passMaterial.setTexture("DepthTexture", textures.get("metres"));
            }
            int columns = (width + step.scale - 1) / step.scale;
            int rows = (height + step.scale - 1) / step.scale;
            // not Pass.init: its frame buffer has one target
            renderFrameBuffer = new FrameBuffer(columns, rows, 1);
            for (String name : step.writes.split(" ")) {
                Texture2D target = new Texture2D(columns, rows, format);
                // without an image's data a texture is clamped, but has the nearest texel
                target.setMagFilter(Texture.MagFilter.Bilinear);
                target.setMinFilter(Texture.MinFilter.BilinearNoMipMaps);
                renderFrameBuffer.addColorTarget(FrameBufferTarget.newTarget(target));
                textures.put(name, target);
                targets.add(target);
            }
            renderFrameBuffer.setMultiTarget(targets.size() > 1);
            renderedTexture = targets.get(0);
        }

        @Override
        public boolean requiresSceneAsTexture() {
            return step.reads.equals("scene");
        }

        @Override
        public boolean requiresDepthAsTexture() {
            return step.pass == BokehPass.LINEAR_DEPTH;
        }

        @Override
        public void cleanup(Renderer renderer) {
            renderFrameBuffer.dispose();
            targets.forEach(target -> target.getImage().dispose());
        }
    }

    @Override
    protected Material getMaterial() {
        material.setTexture("Texture", textures.get("result"));
        return material;
    }

    // getMaterial has the result, and depth is the first pass's
    @Override
    protected boolean isRequiresSceneTexture() {
        return false;
    }

    @Override
    protected boolean isRequiresDepthTexture() {
        return true;
    }

    @Override
    protected void setDepthTexture(Texture depth) {}
}
