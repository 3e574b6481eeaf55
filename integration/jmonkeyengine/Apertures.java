import com.jme3.math.FastMath;
import java.util.Arrays;
import java.util.Map;
import java.util.stream.Stream;

/** Other shapes and methods, and the debug view: tables to take in place of BokehFilter.HEXAGON. */
class Apertures {
    // three targets between the passes over a layer; the first nine passes are the hexagon's
    static final BokehFilter.Step[] OCTAGON = Stream.concat(
            Arrays.stream(BokehFilter.HEXAGON, 0, 9),
            Stream.of(
                    step(BokehPass.LAYER_FILL, "middleHoles farHoles shares reach", "middle back", 4, "Sides", 8f),
                    step(BokehPass.OCTAGON_LAYER_FIRST, "near sizes", "near2 near3 near4", 2, "Layer", 0f),
                    step(BokehPass.OCTAGON_LAYER_SECOND, "near2 near3 near4 - sizes", "nearBlurred", 2, "Layer", 0f),
                    step(BokehPass.OCTAGON_LAYER_FIRST, "far sizes", "far2 far3 far4", 2, "Layer", 1f),
                    step(BokehPass.OCTAGON_LAYER_SECOND, "far2 far3 far4 - sizes", "farBlurred", 2, "Layer", 1f),
                    step(BokehPass.LAYERED, "coc reaches nearBlurred farBlurred middle back", "result", 1, "Sides", 8f)))
            .toArray(BokehFilter.Step[]::new);

    // one layer: cheaper and sharper, but near things keep their outline
    static final BokehFilter.Step[] EXACT_HEXAGON = {
        step(BokehPass.SIGNED_COC_MAP, "scene", "coc", 1),
        step(BokehPass.HEXAGON_FIRST, "coc", "t2 t3", 1),
        step(BokehPass.HEXAGON_SECOND, "t2 t3", "result", 1),
    };
    static final BokehFilter.Step[] EXACT_OCTAGON = {
        step(BokehPass.SIGNED_COC_MAP, "scene", "coc", 1),
        step(BokehPass.OCTAGON_FIRST, "coc", "t2 t3 t4", 1),
        step(BokehPass.OCTAGON_SECOND, "t2 t3 t4", "result", 1),
    };

    // two parallelograms that share the upright line
    static final BokehFilter.Step[] PAPER_HEXAGON = {
        step(BokehPass.COC_MAP, "scene", "coc", 1),
        line(BokehPass.ADAPTIVE, "coc", "upright", 90f),
        line(BokehPass.ADAPTIVE, "upright", "left", 30f),
        line(BokehPass.ADAPTIVE_FINAL, "upright left", "result", 150f),
    };
    // two squares, the second rotated by 45 degrees
    static final BokehFilter.Step[] PAPER_OCTAGON = {
        step(BokehPass.COC_MAP, "scene", "coc", 1),
        line(BokehPass.ADAPTIVE, "coc", "across", 0f),
        line(BokehPass.ADAPTIVE, "across", "square", 90f),
        line(BokehPass.ADAPTIVE, "coc", "rising", 45f),
        line(BokehPass.ADAPTIVE_FINAL, "rising square", "result", 135f),
    };

    // what DebugMode says: 0 colour, 1 depth, 2 CoC, 3 near and far field
    static final BokehFilter.Step[] DEBUG = {
        step(BokehPass.SIGNED_COC_MAP, "scene", "coc", 1),
        step(BokehPass.DEBUG, "coc", "result", 1, "DebugMode", 3f),
    };

    private static BokehFilter.Step step(BokehPass pass, String reads, String writes, int scale) {
        return new BokehFilter.Step(pass, reads, writes, scale, Map.of());
    }

    private static BokehFilter.Step step(BokehPass pass, String reads, String writes, int scale, String name, float value) {
        return new BokehFilter.Step(pass, reads, writes, scale, Map.of(name, value));
    }

    private static BokehFilter.Step line(BokehPass pass, String reads, String writes, float degrees) {
        return step(pass, reads, writes, 1, "Angle", degrees * FastMath.DEG_TO_RAD);
    }
}
