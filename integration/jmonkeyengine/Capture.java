import com.jme3.math.FastMath;
import com.jme3.math.Vector2f;
import com.jme3.system.JmeVersion;
import com.jme3.texture.Image.Format;
import com.jme3.texture.Texture2D;
import com.jme3.util.BufferUtils;
import java.io.ByteArrayOutputStream;
import java.io.File;
import java.io.IOException;
import java.nio.ByteBuffer;
import java.nio.file.Files;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.Collections;
import java.util.List;
import java.util.Locale;
import java.util.Map;
import java.util.StringJoiner;
import java.util.stream.Stream;
import org.lwjgl.opengl.GL11;

/**
 * Writes everything that the shaders read and wrote into a folder, for validation/run engines. Your program does not
 * need this class.
 *
 * <p>It writes color.f16, depth.f32, metres.f32, a .f16 file with the result of each shot, and a .written file with all
 * targets of each layered shot. All of these contain raw rows, beginning at v = 0. capture.json describes them, and has
 * a record of the autofocus.
 */
public class Capture extends Sample {
    // one more pass copies the depth buffer unchanged: its depth kind 0 says that depth is metres already
    private static final BokehFilter.Step[] STORED = Stream.concat(Arrays.stream(Apertures.EXACT_HEXAGON), Stream.of(
            new BokehFilter.Step(BokehPass.LINEAR_DEPTH, "", "stored", 1, Map.of("DepthKind", 0f))))
            .toArray(BokehFilter.Step[]::new);
    private static final List<Shot> SHOTS = List.of(
            shot("layered-hexagon", BokehFilter.HEXAGON),
            shot("layered-octagon", Apertures.OCTAGON),
            shot("exact-hexagon", STORED),
            shot("exact-octagon", Apertures.EXACT_OCTAGON),
            shot("paper-hexagon", Apertures.PAPER_HEXAGON),
            shot("paper-octagon", Apertures.PAPER_OCTAGON),
            shot("layered-hexagon-focused", BokehFilter.HEXAGON),
            shot("exact-octagon-rotated", Apertures.EXACT_OCTAGON),
            shot("paper-hexagon-rotated", Apertures.PAPER_HEXAGON));
    private static final float CLOCKWISE = 10f;
    // scale and limit in front of the focus distance, and behind it
    private static final float[] NEAR = {0.5f, 0.02f}, FAR = {0.75f, 0.03f};
    // number of frames in which the focus moves to the ball, which is nearer than the tower
    private static final int PULLED = 12;
    // index of the frame with a bokeh scale of 0; the next frame has no filter
    private static final int OFF = SHOTS.size() + PULLED;

    private final File folder;
    private final StringJoiner told = new StringJoiner(",\n  ");
    private final StringJoiner pulled = new StringJoiner(", ");
    // screenshots of the frame before OFF, and of all frames from OFF on
    private final List<byte[]> screens = new ArrayList<>();
    private float focusDistance;

    Capture(File folder) {
        super(folder);
        this.folder = folder;
    }

    public static void main(String[] arguments) {
        new Capture(new File(arguments[0])).begin();
    }

    private static Shot shot(String name, BokehFilter.Step[] table) {
        return new Shot(name, table, Scene.TOWER, "result");
    }

    @Override
    List<Shot> shots() {
        List<Shot> all = new ArrayList<>(SHOTS);
        all.addAll(Collections.nCopies(PULLED, shot("pull", Apertures.EXACT_HEXAGON)));
        all.addAll(Collections.nCopies(2, shot("off", Apertures.EXACT_HEXAGON)));
        return all;
    }

    /** Sets up a shot. The frames of the autofocus keep the filter of the shot before them. */
    @Override
    void show(Shot shot, int index) {
        if (index < SHOTS.size()) {
            super.show(shot, index);
            bokeh.setRotation(shot.name().endsWith("rotated") ? CLOCKWISE * FastMath.DEG_TO_RAD : 0f);
            if (shot.name().endsWith("focused")) {
                bokeh.setNearBlur(NEAR[0], NEAR[1]);
                bokeh.setFarBlur(FAR[0], FAR[1]);
            }
        } else if (index == SHOTS.size()) {
            bokeh.setAutofocus(rootNode, PULL_SECONDS, Scene.TOWER, Scene.BALL);
        } else if (index == OFF) {
            bokeh.setBokehScale(0f);
        } else if (index > OFF) {
            filters.removeAllFilters();
        }
    }

    @Override
    void take(Shot shot, int index) throws IOException {
        if (index >= OFF - 1) {
            screens.add(screen());
        }
        if (index >= OFF) {
            return;
        }
        if (index >= SHOTS.size()) {
            pulled.add(Float.toString(bokeh.getFocusDistance()));
            return;
        }
        focusDistance = bokeh.getFocusDistance();
        String name = shot.name();
        String more = "";
        write(name + ".f16", texture("result"), Format.RGBA16F);
        if (name.startsWith("layered")) {
            write(name + ".written", written(shot.table()));
            more = ", \"written\": \"" + name + ".written\"";
        }
        if (name.startsWith("paper")) {
            // capture.json has no preset for paper: give the values of MEDIUM instead
            more = ", \"depth\": \"metres.f32\", \"stored\": null, \"spacing\": 1.5, \"samples\": 9";
            write("metres.f32", texture("metres"), Format.R32F);
        }
        if (name.endsWith("rotated")) {
            more += ", \"clockwise\": " + CLOCKWISE;
        }
        if (name.endsWith("focused")) {
            more += String.format(Locale.ROOT, ", \"focus\": {\"scale\": [%s, %s], \"limits\": [%s, %s]}",
                    NEAR[0], FAR[0], NEAR[1], FAR[1]);
        }
        if (shot.table() == STORED) {
            write("depth.f32", texture("stored"), Format.R32F);
        }
        String[] words = name.split("-");
        told.add(String.format("{\"name\": \"%s\", \"method\": \"%s\", \"aperture\": \"%s\", \"result\": \"%s.f16\"%s}",
                name, words[0], words[1], name, more));
    }

    /** Returns the bytes of all targets that the passes of a table wrote, in the order of the passes. */
    private byte[] written(BokehFilter.Step[] table) throws IOException {
        ByteArrayOutputStream all = new ByteArrayOutputStream();
        for (BokehFilter.Step step : table) {
            for (String target : step.writes().split(" ")) {
                all.write(bytes(read(texture(target), Format.RGBA16F)));
            }
        }
        return all.toByteArray();
    }

    private byte[] screen() {
        ByteBuffer texels = BufferUtils.createByteBuffer(4 * WIDTH * HEIGHT);
        renderer.readFrameBuffer(null, texels);
        return bytes(texels);
    }

    @Override
    void finish(File output) throws IOException {
        boolean same = Arrays.equals(screens.get(1), screens.get(2));
        if (bokeh.isEnabled() || !same || Arrays.equals(screens.get(0), screens.get(1))) {
            throw new IOException("a bokeh scale of 0 changes the image");
        }
        write("color.f16", texture("scene"), Format.RGBA16F);
        float focalLength = 0.5f * 0.024f * cam.getProjectionMatrix().m11;
        String capture = String.format(Locale.ROOT, """
                {"engine": "%s, OpenGL %s", "device": "%s",
                 "width": %d, "height": %d, "color": "color.f16", "depth": "depth.f32",
                 "stored": {"kind": 1, "near": %.9g, "far": %.9g},
                 "camera": {"aperture_diameter": %.9g, "focal_length": %.9g, "focus_distance": %.9g,
                  "sensor_height": 0.024, "max_coc": 0.1},
                 "pull": {"frame": %.9g, "seconds": %.9g, "from": %.9g, "points": [%s, %s], "distances": [%s]},
                 "shots": [
                  %s]}
                """, JmeVersion.FULL_NAME, GL11.glGetString(GL11.GL_VERSION), GL11.glGetString(GL11.GL_RENDERER),
                WIDTH, HEIGHT, cam.getFrustumNear(), cam.getFrustumFar(), 10.0f * focalLength / F_STOP, focalLength, focusDistance, SECONDS, PULL_SECONDS,
                focusDistance, point(Scene.TOWER), point(Scene.BALL), pulled, told);
        write("capture.json", capture.getBytes());
    }

    private String point(Vector2f place) {
        return String.format(Locale.ROOT, "[%.9g, %.9g, %.9g]", place.x, place.y, bokeh.depthUnder(place));
    }

    private static byte[] bytes(ByteBuffer buffer) {
        byte[] all = new byte[buffer.capacity()];
        buffer.get(0, all);
        return all;
    }

    private void write(String name, Texture2D texture, Format format) throws IOException {
        write(name, bytes(read(texture, format)));
    }

    private void write(String name, byte[] data) throws IOException {
        Files.write(folder.toPath().resolve(name), data);
    }
}
