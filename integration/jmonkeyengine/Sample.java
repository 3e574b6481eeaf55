import com.jme3.app.SimpleApplication;
import com.jme3.asset.plugins.FileLocator;
import com.jme3.math.FastMath;
import com.jme3.math.Vector2f;
import com.jme3.post.FilterPostProcessor;
import com.jme3.renderer.RenderManager;
import com.jme3.system.AppSettings;
import com.jme3.system.JmeContext;
import com.jme3.system.NanoTimer;
import com.jme3.texture.FrameBuffer;
import com.jme3.texture.FrameBuffer.FrameBufferTarget;
import com.jme3.texture.Image.Format;
import com.jme3.texture.Texture2D;
import com.jme3.util.BufferUtils;
import java.awt.image.BufferedImage;
import java.io.File;
import java.io.IOException;
import java.io.UncheckedIOException;
import java.nio.ByteBuffer;
import java.util.List;
import javax.imageio.ImageIO;

/**
 * Draws an image of four parts: the input, a hexagon, the near and far field, and an octagon.
 *
 * <p>Run it with {@code java Sample picture.png}.
 */
public class Sample extends SimpleApplication {
    static final int WIDTH = 384;
    static final int HEIGHT = 256;
    // seconds per frame: constant, so that all machines draw the same images
    static final float SECONDS = 1f / 30f;
    // with the default bokeh scale of 10, the blur is ten times as wide as that of a real lens: docs/lens.md
    static final float F_STOP = 2.0f;
    static final float PULL_SECONDS = 0.2f;

    /**
     * Describes a frame.
     *
     * @param name its name
     * @param table table of passes
     * @param focus point of the screen that is in focus
     * @param shown name of the texture that goes into the image
     */
    record Shot(String name, BokehFilter.Step[] table, Vector2f focus, String shown) {}

    private static final List<Shot> SHOTS = List.of(
            new Shot("input", BokehFilter.HEXAGON, Scene.TOWER, "scene"),
            new Shot("hexagon", BokehFilter.HEXAGON, Scene.TOWER, "result"),
            new Shot("fields", Apertures.DEBUG, Scene.TOWER, "result"),
            new Shot("octagon", Apertures.OCTAGON, Scene.BALL, "result"));

    private final File output;
    private final BufferedImage sheet = new BufferedImage(2 * WIDTH, 2 * HEIGHT, BufferedImage.TYPE_INT_RGB);
    BokehFilter bokeh;
    FilterPostProcessor filters;
    private int frame;

    Sample(File output) {
        this.output = output;
    }

    public static void main(String[] arguments) {
        new Sample(new File(arguments[0])).begin();
    }

    /** Starts the application without a visible window. */
    void begin() {
        AppSettings wanted = new AppSettings(true);
        // the shaders are GLSL 3.30
        wanted.setRenderer(AppSettings.LWJGL_OPENGL33);
        wanted.setResolution(WIDTH, HEIGHT);
        wanted.setAudioRenderer(null);
        setSettings(wanted);
        setShowSettings(false);
        start(JmeContext.Type.OffscreenSurface);
    }

    @Override
    public void simpleInitApp() {
        // your game has both folders in its assets
        assetManager.registerLocator("assets", FileLocator.class);
        assetManager.registerLocator("../..", FileLocator.class);
        setDisplayStatView(false);
        setDisplayFps(false);
        flyCam.setEnabled(false);
        setTimer(new NanoTimer() {
            @Override
            public float getTimePerFrame() {
                return SECONDS;
            }
        });
        new Scene(assetManager, rootNode).build();
        Scene.aim(cam);
        filters = new FilterPostProcessor(assetManager);
        // the default, RGB111110F, has too few bits
        filters.setFrameBufferFormat(Format.RGBA16F);
        viewPort.addProcessor(filters);
    }

    @Override
    public void simpleUpdate(float seconds) {
        show(shots().get(frame), frame);
    }

    @Override
    public void simpleRender(RenderManager manager) {
        try {
            take(shots().get(frame), frame);
            if (++frame == shots().size()) {
                finish(output);
                stop();
            }
        } catch (IOException error) {
            throw new UncheckedIOException(error);
        }
    }

    @Override
    public void handleError(String said, Throwable error) {
        System.err.println(said);
        error.printStackTrace();
        System.exit(1);
    }

    List<Shot> shots() {
        return SHOTS;
    }

    /** Copies the shown texture into its part of the image, after a frame was drawn. */
    void take(Shot shot, int index) throws IOException {
        ByteBuffer texels = read(texture(shot.shown), Format.RGBA16F);
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                int rgb = 0;
                for (int channel = 0; channel < 3; channel++) {
                    float light = FastMath.convertHalfToFloat(texels.getShort(8 * (y * WIDTH + x) + 2 * channel));
                    rgb = rgb << 8 | Math.round(255f * FastMath.pow(light / (1f + light), 1f / 2.2f));
                }
                // the first row in memory is the bottom of the image
                sheet.setRGB(x + index % 2 * WIDTH, HEIGHT - 1 - y + index / 2 * HEIGHT, rgb);
            }
        }
    }

    /** Writes the image, after the last frame. */
    void finish(File file) throws IOException {
        ImageIO.write(sheet, "png", file);
    }

    /** Replaces the filter by a new one with the shot's table. */
    void show(Shot shot, int index) {
        filters.removeAllFilters();
        bokeh = new BokehFilter(shot.table);
        bokeh.setFStop(F_STOP);
        bokeh.setAutofocus(rootNode, PULL_SECONDS, shot.focus);
        filters.addFilter(bokeh);
    }

    /** Returns the texture that a pass wrote, by its name, or the texture of the scene for the name "scene". */
    Texture2D texture(String name) {
        return name.equals("scene") ? filters.getFilterTexture() : bokeh.getTexture(name);
    }

    /** Returns the texels of a texture, row by row, beginning at v = 0. Waits for the GPU. */
    ByteBuffer read(Texture2D texture, Format format) {
        int width = texture.getImage().getWidth();
        int height = texture.getImage().getHeight();
        FrameBuffer reader = new FrameBuffer(width, height, 1);
        reader.addColorTarget(FrameBufferTarget.newTarget(texture));
        ByteBuffer texels = BufferUtils.createByteBuffer(width * height * format.getBitsPerPixel() / 8);
        renderer.setFrameBuffer(reader);
        renderer.setViewPort(0, 0, width, height);
        renderer.readFrameBufferWithFormat(reader, texels, format);
        return texels;
    }
}
